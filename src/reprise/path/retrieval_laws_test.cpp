// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// What must hold of any retrieval, on databases made by hand and on the figure's; and what is refused.

#include <algorithm>
#include <functional>
#include <numeric>
#include <random>

#include <gtest/gtest.h>
#include <tbb/global_control.h>

#include "reprise/core/error.h"
#include "reprise/core/interrupt.h"
#include "reprise/path/real_graph_test_support.h"
#include "reprise/path/retrieval_case_test_support.h"

namespace reprise {
namespace {

using test::moved;
using test::pose_of;
using test::random_move;
using test::random_track;
using test::RetrievalCase;
using test::ShownNode;

// Three motions of one body and a transition from the first to the second.
RetrievalCase three_clips() {
  std::mt19937 random(3);
  RetrievalCase c;
  for (int clip = 0; clip < 3; ++clip) c.tracks.push_back(random_track(40, 12, random));
  Transition transition;
  transition.source_clip = 0;
  transition.target_clip = 1;
  transition.m = 25;
  transition.n = 14;
  transition.half_window = 4;
  transition.source_from_target = random_move(random);
  transition.cost = 0.37;
  c.transitions.push_back(transition);
  return c;
}

// Frames of the path from the first, one by one.
std::vector<int> one_by_one(std::size_t count) {
  std::vector<int> frames(count);
  std::iota(frames.begin(), frames.end(), 0);
  return frames;
}

TEST(RetrievalLaws, AQueryCutOutOfTheDatabaseComesBackForNothing) {
  RetrievalCase c = three_clips();
  c.query.assign(c.tracks[2].begin() + 7, c.tracks[2].begin() + 31);
  const auto answers = c.retrieve();
  ASSERT_TRUE(answers.has_value()) << answers.error().reason;
  const Retrieval& answer = answers->front();
  ASSERT_EQ(answer.path.segments.size(), 1U);
  EXPECT_EQ(answer.path.segments[0].clip_idx, 2U);
  EXPECT_EQ(answer.path.segments[0].first_frame, 7);
  EXPECT_EQ(answer.path.segments[0].last_frame, 30);
  EXPECT_EQ(answer.path_frame, one_by_one(24));
  EXPECT_NEAR(answer.cost, 0.0, 1e-9);
}

TEST(RetrievalLaws, APaceIsFollowedByRepeatsAndSkips) {
  RetrievalCase c = three_clips();
  // Every frame twice, then every other one.
  std::vector<int> frames;
  for (int f = 4; f < 12; ++f) frames.insert(frames.end(), {f, f});
  for (int f = 12; f < 36; f += 2) frames.push_back(f);
  for (const int f : frames) c.query.push_back(c.tracks[1][static_cast<std::size_t>(f)]);
  const auto answers = c.retrieve();
  ASSERT_TRUE(answers.has_value()) << answers.error().reason;
  const Retrieval& answer = answers->front();
  EXPECT_NEAR(answer.cost, 0.0, 1e-9);
  EXPECT_EQ(answer.repeats, 8);
  EXPECT_EQ(answer.skips, 11);
  for (std::size_t k = 0; k < frames.size(); ++k) EXPECT_EQ(answer.path_frame[k], frames[k] - 4);
}

TEST(RetrievalLaws, MovesOfTheQueryAndOfClipsOnTheGroundChangeNothing) {
  std::mt19937 random(17);
  RetrievalCase c = three_clips();
  c.options.threshold = 2.0;
  c.query = random_track(30, 12, random);
  const auto expected = c.retrieve();
  ASSERT_TRUE(expected.has_value());
  const GroundTransform of_query = random_move(random);
  for (Eigen::MatrixX3d& joints : c.query) joints = moved(of_query, joints);
  // A clip takes its transitions along.
  const GroundTransform of_target = random_move(random);
  for (Eigen::MatrixX3d& joints : c.tracks[1]) joints = moved(of_target, joints);
  GroundTransform& source_from_target = c.transitions[0].source_from_target;
  source_from_target = source_from_target * of_target.inverse();
  const auto answers = c.retrieve();
  ASSERT_TRUE(answers.has_value());
  EXPECT_EQ(answers->front().path_frame, expected->front().path_frame);
  EXPECT_EQ(test::answer_nodes(c, answers->front()), test::answer_nodes(c, expected->front()));
  EXPECT_NEAR(answers->front().cost, expected->front().cost, 1e-9);
}

TEST(RetrievalLaws, AQueryAcrossABlendPaysForItOnce) {
  RetrievalCase c = three_clips();
  const Transition& t = c.transitions[0];
  for (int f = 15; f <= t.leave(); ++f) c.query.push_back(c.tracks[0][static_cast<std::size_t>(f)]);
  for (int b = 0; b < 2 * t.half_window - 1; ++b) c.query.push_back(pose_of(c, {true, 0, b}).joints);
  for (int f = t.arrive(); f < 30; ++f) c.query.push_back(c.tracks[1][static_cast<std::size_t>(f)]);
  const auto answers = c.retrieve();
  ASSERT_TRUE(answers.has_value()) << answers.error().reason;
  const Retrieval& answer = answers->front();
  EXPECT_NEAR(answer.cost, t.cost, 1e-9);
  EXPECT_EQ(answer.transitions, 1);
  EXPECT_EQ(answer.path_frame, one_by_one(c.query.size()));
  ASSERT_EQ(answer.path.segments.size(), 2U);
  EXPECT_EQ(answer.path.segments[0].last_frame, t.leave());
  EXPECT_EQ(answer.path.segments[1].first_frame, t.arrive());
  EXPECT_EQ(answer.path.segments[1].last_frame, 29);
  EXPECT_EQ(answer.path.frame_count, static_cast<int>(c.query.size()));
}

TEST(RetrievalLaws, APathThatEndsInsideABlendHoldsTheWholeBlend) {
  RetrievalCase c = three_clips();
  const Transition& t = c.transitions[0];
  for (int f = 15; f <= t.leave(); ++f) c.query.push_back(c.tracks[0][static_cast<std::size_t>(f)]);
  const std::size_t pure = c.query.size();
  for (int b = 0; b < 4; ++b) c.query.push_back(pose_of(c, {true, 0, b}).joints);
  const auto answers = c.retrieve();
  ASSERT_TRUE(answers.has_value()) << answers.error().reason;
  const Retrieval& answer = answers->front();
  EXPECT_NEAR(answer.cost, t.cost, 1e-9);
  EXPECT_EQ(answer.path_frame, one_by_one(c.query.size()));
  ASSERT_EQ(answer.path.segments.size(), 2U);
  EXPECT_EQ(answer.path.segments[1].first_frame, t.arrive());
  EXPECT_EQ(answer.path.segments[1].last_frame, t.arrive());
  EXPECT_EQ(answer.path.frame_count, static_cast<int>(pure) + 2 * t.half_window - 1 + 1);
}

TEST(RetrievalLaws, VelocitiesTellAPoseFromTheSameOnTheWayBack) {
  // Clip 1 shows what the query shows, but backwards; clip 0 forwards, in a body of somewhat other build.
  RetrievalCase c = three_clips();
  c.tracks.resize(2);
  c.transitions.clear();
  c.tracks[1].assign(c.tracks[0].rbegin(), c.tracks[0].rend());
  c.query.assign(c.tracks[0].begin() + 17, c.tracks[0].begin() + 24);
  std::mt19937 random(8);
  std::normal_distribution<double> normal(0.0, 0.1);
  Eigen::MatrixX3d build(12, 3);
  for (double& value : build.reshaped()) value = normal(random);
  for (Eigen::MatrixX3d& joints : c.tracks[0]) joints += build;
  c.options.most_repeats = 10;
  const auto by_pose = c.retrieve();
  ASSERT_TRUE(by_pose.has_value());
  EXPECT_EQ(by_pose->front().path.segments[0].clip_idx, 1U);
  c.options.velocity_weight = 5.0;
  c.options.threshold = 10.0;
  const auto by_velocity = c.retrieve();
  ASSERT_TRUE(by_velocity.has_value());
  EXPECT_EQ(by_velocity->front().path.segments[0].clip_idx, 0U);
}

// A query and a database large enough for every loop to be shared among threads.
TEST(RetrievalLaws, ThreadsChangeNothing) {
  std::mt19937 random(23);
  RetrievalCase c;
  for (int clip = 0; clip < 24; ++clip) c.tracks.push_back(random_track(900, 4, random));
  for (int i = 0; i < 300; ++i) {
    Transition transition;
    transition.source_clip = random() % 24;
    transition.target_clip = random() % 24;
    transition.half_window = 1 + static_cast<int>(random() % 12);
    transition.m = 20 + static_cast<int>(random() % 860);
    transition.n = 20 + static_cast<int>(random() % 860);
    transition.source_from_target = random_move(random);
    transition.cost = 0.001 * static_cast<double>(random() % 100);
    c.transitions.push_back(transition);
  }
  c.query = random_track(70, 4, random);
  c.options.threshold = 5.0;
  c.options.count = 2;
  const SkeletonRetriever retriever = c.retriever();
  const auto answers = retriever.retrieve(c.query, c.options);
  const tbb::global_control one_thread(tbb::global_control::max_allowed_parallelism, 1);
  const auto alone = retriever.retrieve(c.query, c.options);
  ASSERT_TRUE(answers.has_value() && alone.has_value());
  ASSERT_EQ(answers->size(), 2U);
  ASSERT_EQ(alone->size(), 2U);
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_EQ((*answers)[i].cost, (*alone)[i].cost);
    EXPECT_EQ((*answers)[i].path_frame, (*alone)[i].path_frame);
    EXPECT_EQ(test::answer_nodes(c, (*answers)[i]), test::answer_nodes(c, (*alone)[i]));
  }
}

// The figure's joints, as its makers know them.
struct FigureTracks {
  std::vector<JointTrack> tracks;
  std::vector<std::string> names;
  SkeletonRetriever retriever() const {
    return {tracks, names, test::figure_graph().transitions, BlendProfile::smooth, 25.0};
  }
};

JointTrack track_of(const std::vector<SkeletonPose>& poses) {
  JointTrack track;
  for (const SkeletonPose& pose : poses) {
    track.emplace_back(static_cast<Eigen::Index>(pose.position.size()), 3);
    for (std::size_t j = 0; j < pose.position.size(); ++j) {
      track.back().row(static_cast<Eigen::Index>(j)) = pose.position[j].transpose();
    }
  }
  return track;
}

FigureTracks figure_tracks() {
  FigureTracks result;
  const PerformanceDatabase& database = test::figure_graph().database;
  for (std::size_t clip = 0; clip < database.clips().size(); ++clip) {
    result.tracks.push_back(track_of(database.truth(clip)->poses));
    result.names.push_back(database.clip(clip).name());
  }
  return result;
}

TEST(FigureRetrieval, AWalkLeftOutIsFoundInTheOtherClips) {
  const FigureTracks figure = figure_tracks();
  const SkeletonRetriever retriever = figure.retriever();
  const auto walk = static_cast<std::size_t>(std::ranges::find(figure.names, "walk") - figure.names.begin());
  const JointTrack& query = figure.tracks[walk];
  const auto answers = retriever.retrieve(query, {.forbidden_clips = {walk}, .count = 3});
  ASSERT_TRUE(answers.has_value()) << answers.error().reason;
  // Other walks of the same body come near: the paper's threshold is far away.
  const std::vector<double>& first = answers->front().dissimilarity;
  EXPECT_LT(std::accumulate(first.begin(), first.end(), 0.0) / static_cast<double>(first.size()), 0.06);
  ASSERT_EQ(answers->size(), 3U);
  for (std::size_t i = 0; i < 3; ++i) {
    EXPECT_GE((*answers)[i].cost, answers->front().cost);
    for (const PathSegment& segment : (*answers)[i].path.segments) EXPECT_NE(segment.clip_idx, walk);
  }
}

TEST(FigureRetrieval, AnotherPaceIsMetByRepeatsOrSkips) {
  const FigureTracks figure = figure_tracks();
  const SkeletonRetriever retriever = figure.retriever();
  const PerformanceDatabase& database = test::figure_graph().database;
  const std::size_t walk = database.clip_idx("walk");
  for (const double pace : {0.75, 1.3}) {
    SkeletalMotion motion{.name = "walk",
                          .skeleton = database.markup()->skeleton,
                          .frames_per_second = 25.0,
                          .frames = database.truth(walk)->poses};
    const JointTrack query = track_of(resample(motion, 25.0 / pace).frames);
    const auto answers = retriever.retrieve(query);
    ASSERT_TRUE(answers.has_value()) << answers.error().reason;
    const Retrieval& answer = answers->front();
    EXPECT_LT(*std::ranges::max_element(answer.dissimilarity), 0.05);
    EXPECT_NEAR(answer.path_frame.back() / static_cast<double>(query.size() - 1), pace, 0.1);
  }
}

std::string refusal(const std::function<void()>& call) {
  try {
    call();
  } catch (const InvalidArgument& error) {
    return error.what();
  }
  return "not refused";
}

TEST(RetrievalRefusal, NamesWhatIsWrong) {
  const RetrievalCase c = three_clips();
  const SkeletonRetriever retriever = c.retriever();
  const JointTrack query(c.tracks[0].begin(), c.tracks[0].begin() + 5);
  const auto expect = [&](const char* words, const RetrievalOptions& options) {
    const std::string message = refusal([&] { (void)retriever.retrieve(query, options); });
    EXPECT_NE(message.find(words), std::string::npos) << message;
  };
  expect("retrieval_weight", {.retrieval_weight = -1.0});
  expect("retrieval_weight", {.retrieval_weight = std::nan("")});
  expect("velocity_weight", {.velocity_weight = -0.1});
  expect("joint_weights has 3", {.joint_weights = {1.0, 2.0, 3.0}});
  expect("joint_weights is -1", {.joint_weights = std::vector<double>(12, -1.0)});
  expect("all joint_weights are 0", {.joint_weights = std::vector<double>(12, 0.0)});
  expect("threshold", {.threshold = 0.0});
  expect("threshold", {.threshold = std::nan("")});
  expect("most_repeats is -1", {.most_repeats = -1});
  expect("most_repeats is 64", {.most_repeats = 64});
  expect("repeat_cost", {.repeat_cost = -1.0});
  expect("skip_cost", {.skip_cost = std::numeric_limits<double>::infinity()});
  expect("clip 3 of 3", {.forbidden_clips = {3}});
  expect("count", {.count = 0});
  expect("apart", {.apart = -1});

  // Queries.
  EXPECT_NE(refusal([&] { (void)retriever.retrieve({}); }).find("no frames"), std::string::npos);
  JointTrack fewer = query;
  fewer[3] = fewer[3].topRows(11).eval();
  EXPECT_NE(refusal([&] { (void)retriever.retrieve(fewer); }).find("frame 3: 11 joints, expected 12"),
            std::string::npos);
  JointTrack unknown = query;
  unknown[2](4, 1) = std::nan("");
  EXPECT_NE(refusal([&] { (void)retriever.retrieve(unknown); }).find("frame 2"), std::string::npos);
}

TEST(RetrievalRefusal, NamesWhatDoesNotFitTogether) {
  const auto expect = [&](const char* words, const std::function<void(RetrievalCase&)>& change) {
    RetrievalCase c = three_clips();
    change(c);
    const std::string message = refusal([&] { (void)c.retriever(); });
    EXPECT_NE(message.find(words), std::string::npos) << message;
  };
  expect("no clip", [](RetrievalCase& c) { c.tracks.clear(); });
  expect("clip 1 has no frames", [](RetrievalCase& c) { c.tracks[1].clear(); });
  expect("11 joints", [](RetrievalCase& c) { c.tracks[1][5] = c.tracks[1][5].topRows(11).eval(); });
  expect("no finite", [](RetrievalCase& c) { c.tracks[2][39](0, 0) = std::nan(""); });
  expect("without joints", [](RetrievalCase& c) {
    for (JointTrack& track : c.tracks) {
      for (Eigen::MatrixX3d& joints : track) joints.resize(0, 3);
    }
  });
  expect("target clip 7", [](RetrievalCase& c) { c.transitions[0].target_clip = 7; });
  expect("half window 0", [](RetrievalCase& c) { c.transitions[0].half_window = 0; });
  expect("leaves the source clip", [](RetrievalCase& c) { c.transitions[0].m = 38; });
  expect("leaves the target clip", [](RetrievalCase& c) { c.transitions[0].n = 2; });
  expect("cost", [](RetrievalCase& c) { c.transitions[0].cost = -0.5; });

  const RetrievalCase c = three_clips();
  const auto make = [&](const std::vector<std::string>& names, double rate) {
    return refusal([&] { SkeletonRetriever(c.tracks, names, c.transitions, c.profile, rate); });
  };
  EXPECT_NE(make({"a"}, 25.0).find("1 names for 3 clips"), std::string::npos);
  EXPECT_NE(make(c.names(), 0.0).find("frames per second"), std::string::npos);
}

TEST(RetrievalRefusal, StopsWhenAsked) {
  const RetrievalCase c = three_clips();
  const SkeletonRetriever retriever = c.retriever();
  set_interrupted(true);
  EXPECT_THROW((void)retriever.retrieve(c.tracks[0]), Cancelled);
  set_interrupted(false);
}

}  // namespace
}  // namespace reprise
