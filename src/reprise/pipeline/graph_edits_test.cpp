// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// Edits of a graph: each alone, through the file, and when everything is computed anew.

#include <algorithm>
#include <functional>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "reprise/core/error.h"
#include "reprise/graph/graph_components.h"
#include "reprise/pipeline/graph.h"
#include "support/captured_log.h"
#include "support/shapes.h"
#include "support/test_data.h"

namespace reprise {
namespace {

using ::testing::AllOf;
using ::testing::HasSubstr;
using ::testing::IsEmpty;
using ::testing::Not;
using Origin = GraphEdge::Origin;

auto place(const Transition& t) {
  return std::tuple(t.source_clip, t.m, t.target_clip, t.n, t.half_window);
}

auto fields(const Transition& t) {
  return std::tuple(place(t), t.source_from_target.yaw, t.source_from_target.translation.x(),
                    t.source_from_target.translation.y(), t.distortion, t.peak_acceleration, t.cost);
}

auto all_fields(const std::vector<Transition>& transitions) {
  std::vector<decltype(fields(transitions[0]))> result;
  for (const Transition& t : transitions) result.push_back(fields(t));
  return result;
}

class GraphEdits : public ::testing::Test {
 protected:
  GraphEdits() {
    database_.add(test::walk("slow", 70, 0.03, 20.0));
    database_.add(test::walk("fast", 60, 0.06, 20.0, 7.0));
    graph_ = edited({});
  }

  // As the command does it.
  SurfaceMotionGraph edited(const GraphOptions& edits, const std::optional<SurfaceMotionGraph>& previous,
                            SimilarityOptions similarity = {}) const {
    similarity.use_cache = false;
    similarity.transitions.max_pop_ratio = 100.0;  // these walks are smoother than any blend of them
    similarity.requests = requested_transitions(database_, edits, previous);
    return make_graph(database_, compute_similarity(database_, folder_ / "db", similarity), edits, previous);
  }
  SurfaceMotionGraph edited(const GraphOptions& edits) const { return edited(edits, std::nullopt); }
  // The same from the file of `previous`.
  SurfaceMotionGraph anew(const SurfaceMotionGraph& previous, const SimilarityOptions& similarity = {},
                          const GraphOptions& edits = {}) const {
    save_graph(previous, folder_ / "graph.json");
    return edited(edits, load_graph(folder_ / "graph.json"), similarity);
  }
  std::string error(const GraphOptions& edits) const { return error(edits, graph_); }
  std::string error(const GraphOptions& edits, const SurfaceMotionGraph& previous) const {
    try {
      edited(edits, previous);
    } catch (const InvalidArgument& refusal) {
      return refusal.what();
    }
    return "";
  }
  std::string warning(const GraphOptions& edits, const SurfaceMotionGraph& previous) const {
    const test::CapturedLog log;
    edited(edits, previous);
    return log.text();
  }

  static const GraphEdge* find(const SurfaceMotionGraph& graph, const Transition& t) {
    static std::vector<GraphEdge> edges;
    edges = graph.edges();
    const auto at =
        std::ranges::find(edges, place(t), [](const GraphEdge& edge) { return place(edge.transition); });
    return at == edges.end() ? nullptr : &*at;
  }
  static std::vector<Transition> of_pair(const SurfaceMotionGraph& graph, std::size_t source,
                                         std::size_t target) {
    std::vector<Transition> result;
    for (const Transition& t : graph.active_transitions()) {
      if (t.source_clip == source && t.target_clip == target) result.push_back(t);
    }
    return result;
  }

  test::TemporaryFolder folder_;
  PerformanceDatabase database_;
  SurfaceMotionGraph graph_;
};

// Finds less, elsewhere and with other windows.
const SimilarityOptions other_options = {
    .transitions = {.transitions_per_pair = 1, .min_half_window = 5, .separation = 2}};

TEST_F(GraphEdits, RemovalsSurviveRecomputationAndCanBeTakenBack) {
  const SurfaceMotionGraph cut = edited({.remove = {"slow->fast"}}, graph_);
  EXPECT_THAT(of_pair(cut, 0, 1), IsEmpty());
  EXPECT_EQ(all_fields(of_pair(cut, 1, 0)), all_fields(of_pair(graph_, 1, 0))) << "one way";
  EXPECT_THAT(of_pair(anew(cut), 0, 1), IsEmpty());
  EXPECT_THAT(of_pair(anew(anew(cut), other_options), 0, 1), IsEmpty());
  const SurfaceMotionGraph restored = anew(cut, {}, {.restore = {"slow->fast"}});
  EXPECT_EQ(all_fields(restored.active_transitions()), all_fields(graph_.active_transitions()));
}

TEST_F(GraphEdits, APatternForbidsEveryPairItMatches) {
  const SurfaceMotionGraph cut = edited({.remove = {"*->fast"}}, graph_);
  EXPECT_THAT(of_pair(cut, 0, 1), IsEmpty());
  EXPECT_THAT(of_pair(cut, 1, 1), IsEmpty());
  EXPECT_THAT(of_pair(cut, 1, 0), Not(IsEmpty()));
  EXPECT_THAT(of_pair(anew(cut, other_options), 1, 1), IsEmpty());
}

TEST_F(GraphEdits, ARemovedTransitionStaysOutWhereverItMovesNearby) {
  const Transition out = of_pair(graph_, 0, 1).front();
  const SurfaceMotionGraph cut = edited({.remove = {to_string(out, graph_)}}, graph_);
  EXPECT_EQ(cut.active_transitions().size(), graph_.active_transitions().size() - 1);
  // Others are found close by when they may lie closer together: the removal means what it meant.
  const SurfaceMotionGraph closer =
      anew(cut, {.transitions = {.transitions_per_pair = 100, .separation = 1}});
  for (const Transition& t : of_pair(closer, 0, 1)) {
    EXPECT_TRUE(std::abs(t.m - out.m) >= 6 || std::abs(t.n - out.n) >= 6);
  }
  EXPECT_GT(closer.edges().size(), closer.active_transitions().size());
}

TEST_F(GraphEdits, AProtectedTransitionStaysWhateverHappens) {
  const Transition t = of_pair(graph_, 0, 1).back();
  const SurfaceMotionGraph kept = edited({.protect = {to_string(t, graph_)}}, graph_);
  ASSERT_EQ(kept.kept.size(), 1U);
  EXPECT_EQ(all_fields(kept.active_transitions()), all_fields(graph_.active_transitions()));
  // Removed with all others, also by a later edit.
  const SurfaceMotionGraph cut = anew(kept, {}, {.remove = {"*->*"}});
  EXPECT_EQ(all_fields(cut.active_transitions()), all_fields({t}));
  // Not found any more.
  const SurfaceMotionGraph other = anew(cut, other_options);
  ASSERT_EQ(std::ranges::count(other.transitions, place(t), place), 0) << "the options must lose it";
  ASSERT_EQ(other.active_transitions().size(), 1U);
  EXPECT_EQ(place(other.active_transitions()[0]), place(t));
  EXPECT_EQ(find(other, t)->origin, Origin::kept);
  // Pruned.
  const SurfaceMotionGraph pruned = anew(other, {}, {.pruning = Pruning::both_ends});
  EXPECT_EQ(all_fields(pruned.active_transitions()), all_fields({t})) << "and the very same when found again";
  // Let go.
  const SurfaceMotionGraph gone = anew(pruned, {}, {.unprotect = {"slow->fast"}, .pruning = Pruning::none});
  EXPECT_THAT(gone.active_transitions(), IsEmpty());
  const SurfaceMotionGraph back = anew(gone, {}, {.restore = {"*->*"}});
  EXPECT_EQ(all_fields(back.active_transitions()), all_fields(graph_.active_transitions()));
}

TEST_F(GraphEdits, ProtectionMeansWhatIsInForceOrWhatIsNamed) {
  const Transition best = of_pair(graph_, 0, 1).front();
  const SurfaceMotionGraph cut = edited({.remove = {to_string(best, graph_)}}, graph_);
  EXPECT_EQ(edited({.protect = {"slow->fast"}}, cut).kept.size(), of_pair(graph_, 0, 1).size() - 1);
  EXPECT_NE(find(edited({.protect = {to_string(best, graph_)}}, cut), best), nullptr);
  EXPECT_EQ(edited({.protect = {to_string(best, graph_)}}, cut).active_transitions().size(),
            graph_.active_transitions().size())
      << "who names it brings it back";
  const SurfaceMotionGraph none = edited({.remove = {"slow->fast"}}, graph_);
  EXPECT_THAT(error({.protect = {"slow->fast"}}, none), HasSubstr("none of them in force"));
  EXPECT_THAT(error({.protect = {"slow:0->fast:59"}}), HasSubstr("matches no transition"));
  EXPECT_THAT(error({.unprotect = {"slow->fast"}}), HasSubstr("is not protected"));
  const SurfaceMotionGraph twice =
      edited({.protect = {"slow->fast"}}, edited({.protect = {"slow->fast"}}, graph_));
  EXPECT_EQ(twice.kept.size(), of_pair(graph_, 0, 1).size()) << "protecting twice is protecting once";
}

TEST_F(GraphEdits, AHandMadeTransitionIsMeasuredLikeAFoundOne) {
  // At the place of a found one it is the found one.
  const Transition found = of_pair(graph_, 1, 0).front();
  const SurfaceMotionGraph same = edited({.add = {to_string(found, graph_)}}, graph_);
  ASSERT_EQ(same.added.size(), 1U);
  EXPECT_EQ(fields(same.added[0]), fields(found));
  EXPECT_EQ(same.edges().size(), graph_.edges().size());
  // Anywhere else it is what measuring says.
  const SurfaceMotionGraph graph = edited({.add = {"slow:31->fast:22@8", "fast:40->slow:33"}}, graph_);
  ASSERT_EQ(graph.added.size(), 2U);
  EXPECT_EQ(graph.active_transitions().size(), graph_.active_transitions().size() + 2);
  EXPECT_EQ(graph.added[0].half_window, 8);
  for (const Transition& t : graph.added) {
    EXPECT_EQ(find(graph, t)->origin, Origin::added);
    EXPECT_EQ(find(graph, t)->state, GraphEdge::State::in_force);
    EXPECT_GT(t.cost, 0.0);
  }
}

TEST_F(GraphEdits, AHandMadeTransitionSurvivesAndIsMeasuredAnew) {
  const SurfaceMotionGraph graph = edited({.remove = {"*->*"}, .add = {"slow:31->fast:22"}}, graph_);
  EXPECT_EQ(graph.active_transitions().size(), 1U) << "no pattern removes it";
  const Transition by_vertex = graph.added[0];
  EXPECT_EQ(all_fields(anew(graph).added), all_fields({by_vertex}));
  // Costs of another metric and profile, of the same frames and window; from a matrix of bounds.
  constexpr HistogramOptions coarse = {.radius_bins = 3,
                                       .polar_bins = 4,
                                       .azimuth_bins = 8,
                                       .color_bins = {2, 2, 2},
                                       .azimuth_refinement = 4,
                                       .voxel_size = 0.1};
  const SurfaceMotionGraph shape =
      anew(graph, {.metric = "shape", .histogram = coarse, .transitions = {.profile = BlendProfile::linear}});
  ASSERT_EQ(shape.added.size(), 1U);
  EXPECT_EQ(place(shape.added[0]), place(by_vertex));
  EXPECT_NE(shape.added[0].cost, by_vertex.cost);
  EXPECT_EQ(all_fields(anew(shape).added), all_fields({by_vertex})) << "and back";
  // Dropped.
  const SurfaceMotionGraph dropped = anew(graph, {}, {.drop = {"slow:31->fast:22"}});
  EXPECT_THAT(dropped.added, IsEmpty());
  EXPECT_THAT(dropped.active_transitions(), IsEmpty());
}

TEST_F(GraphEdits, AHandMadeTransitionTakesTheNewerWindow) {
  const SurfaceMotionGraph first = edited({.add = {"slow:31->fast:22@8"}}, graph_);
  const SurfaceMotionGraph second = edited({.add = {"slow:31->fast:22@9"}}, first);
  ASSERT_EQ(second.added.size(), 1U);
  EXPECT_EQ(second.added[0].half_window, 9);
}

TEST_F(GraphEdits, PruningStaysAndFollowsWhatIsFound) {
  // Without a way back every walk that leaves `slow` for `fast` and cannot loop there ends.
  const GraphOptions edits{.remove = {"fast->slow", "fast->fast"}, .pruning = Pruning::dead_ends};
  const SurfaceMotionGraph pruned = edited(edits, graph_);
  EXPECT_THAT(of_pair(pruned, 0, 1), IsEmpty());
  EXPECT_THAT(of_pair(pruned, 0, 0), Not(IsEmpty()));
  EXPECT_THAT(of_pair(anew(pruned), 0, 1), IsEmpty());
  EXPECT_THAT(of_pair(anew(pruned, {}, {.restore = {"fast->slow"}}), 0, 1), Not(IsEmpty()))
      << "no dead end any more";
  EXPECT_THAT(of_pair(anew(pruned, {}, {.pruning = Pruning::none}), 0, 1), Not(IsEmpty()));
  // What is left goes on for ever.
  const std::vector<Transition> left = pruned.active_transitions();
  const std::vector<int> frame_counts = {70, 60};
  const GraphComponents components = find_components(frame_counts, left);
  EXPECT_EQ(std::ranges::count(components.goes_on, false), 0);
}

TEST_F(GraphEdits, WarnOfWhatChangesNothing) {
  const SurfaceMotionGraph cut = edited({.remove = {"slow->fast"}}, graph_);
  EXPECT_THAT(warning({.remove = {"slow->fast"}}, cut), HasSubstr("no transition that was still there"));
  EXPECT_EQ(edited({.remove = {"slow->fast"}}, cut).removed.size(), 1U);
  EXPECT_THAT(warning({.remove = {"slow->fast"}}, graph_), IsEmpty());
  const SurfaceMotionGraph kept = edited({.protect = {"slow->fast"}}, graph_);
  EXPECT_THAT(warning({.remove = {"slow->fast"}}, kept), HasSubstr("protected or made by hand"));
}

TEST_F(GraphEdits, RefuseWhatDoesNotExist) {
  EXPECT_THAT(error({.restore = {"fast->slow"}}), HasSubstr("was not removed"));
  const SurfaceMotionGraph cut = edited({.remove = {"*->fast"}}, graph_);
  EXPECT_THAT(error({.restore = {"slow->fast"}}, cut), HasSubstr("removed are *->fast"));
  EXPECT_THAT(error({.remove = {"slwo->fast"}}), HasSubstr("did you mean 'slow'?"));
  EXPECT_THAT(error({.remove = {"slow:70->fast:3"}}), HasSubstr("frames 0 to 69"));
  EXPECT_THAT(error({.protect = {"slow"}}), HasSubstr("expected CLIP->CLIP"));
  EXPECT_THAT(error({.drop = {"slow->fast"}}),
              AllOf(HasSubstr("was not made by hand"), HasSubstr("--remove")));
  EXPECT_THAT(error({.add = {"slow->fast"}}), HasSubstr("which frames meet"));
  EXPECT_THAT(error({.add = {"slow:3->fast:99"}}), HasSubstr("frames 0 to 59, asked for '99'"));
  EXPECT_THAT(error({.add = {"slow:20->fast:20@21"}}), HasSubstr("the longest that does is 20"));
  EXPECT_THAT(error({.add = {"slow:1->fast:20"}}), HasSubstr("does not fit"));
  EXPECT_THAT(error({.add = {"slow:20->slow:20"}}), HasSubstr("to itself"));
}

TEST_F(GraphEdits, OfAnotherDatabaseAreRefusedIfTheyDoNotFit) {
  const SurfaceMotionGraph previous =
      edited({.remove = {"*->fast"}, .add = {"slow:60->fast:50@5"}, .protect = {"slow->slow"}}, graph_);
  const auto refusal = [&](std::vector<MeshSequence> clips, const SurfaceMotionGraph& old) -> std::string {
    const PerformanceDatabase other = test::database_of(std::move(clips));
    try {
      const SimilarityResult similarity = compute_similarity(other, folder_ / "other", {.use_cache = false});
      make_graph(other, similarity, {}, old);
    } catch (const InvalidArgument& error) {
      return error.what();
    }
    return "";
  };
  const MeshSequence slow = database_.clip(0);
  const MeshSequence fast = database_.clip(1);
  // The same clips in another order: by name.
  EXPECT_EQ(refusal({fast, slow}, previous), "");
  // Too short for the hand-made one; without the clip.
  const MeshSequence shorter = test::walk("slow", 50, 0.03, 20.0);
  EXPECT_THAT(refusal({shorter, fast}, previous),
              AllOf(HasSubstr("frames 0 to 49"), HasSubstr("belongs to another database")));
  EXPECT_THAT(refusal({slow}, edited({.add = {"slow:60->fast:50@5"}}, graph_)),
              AllOf(HasSubstr("the graph that is there has slow:60->fast:50@5"),
                    HasSubstr("belongs to another database")));
  EXPECT_THAT(refusal({slow}, edited({.remove = {"slow->fast"}}, graph_)),
              AllOf(HasSubstr("removes slow->fast"), HasSubstr("no clip 'fast'")));
  EXPECT_EQ(refusal({slow}, edited({.remove = {"*->f*"}}, graph_)), "") << "a pattern may match nothing";
  // Other contents: the edits are kept, with a warning.
  const test::CapturedLog log;
  EXPECT_EQ(refusal({test::walk("slow", 70, 0.031, 20.0), fast}, previous), "");
  EXPECT_THAT(log.text(), HasSubstr("made from other contents"));
}

TEST_F(GraphEdits, TheDescriptionCountsWhatIsThere) {
  const SurfaceMotionGraph graph =
      edited({.remove = {"fast->*"}, .add = {"slow:31->slow:22@8"}, .protect = {"slow->slow"}}, graph_);
  const std::string text = describe_graph(graph);
  EXPECT_THAT(text, AllOf(HasSubstr("1 made by hand"), HasSubstr("component 1: "), HasSubstr("slow: frames "),
                          HasSubstr("go on for ever (component 1)"), HasSubstr("fast: frames ")));
  EXPECT_THAT(text, HasSubstr("only lead out"));
  EXPECT_THAT(describe_graph(edited({.remove = {"*->*"}}, graph_)),
              AllOf(HasSubstr("transitions: 0 in force"), HasSubstr("components: none")));
}

}  // namespace
}  // namespace reprise
