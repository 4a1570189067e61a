// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/graph/surface_motion_graph.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "reprise/graph/graph_test_support.h"

namespace reprise {
namespace {

using test::argument_error;
using ::testing::AllOf;
using ::testing::HasSubstr;
using GraphTest = test::GraphTest;

TEST_F(GraphTest, KnowsItsDatabase) {
  EXPECT_EQ(graph_.database_hash, database_.content_hash());
  EXPECT_EQ(graph_.metric, "vertex");
  ASSERT_EQ(graph_.clips.size(), 2U);
  EXPECT_EQ(graph_.clips[1].name, "stroll");
  EXPECT_EQ(graph_.clips[1].frame_count, 40);
  EXPECT_FALSE(graph_.transitions.empty());
  EXPECT_NO_THROW(check_graph_fits(graph_, database_));
}

TEST_F(GraphTest, RemovingAPairRemovesItsTransitionsOneWay) {
  graph_.removed = {{.source_clip = "walk", .target_clip = "stroll"}};
  std::size_t others = 0;
  for (const Transition& t : graph_.transitions) {
    const bool is_meant = t.source_clip == 0 && t.target_clip == 1;
    EXPECT_EQ(graph_.is_removed(t), is_meant);
    others += is_meant ? 0 : 1;
  }
  EXPECT_EQ(graph_.active_transitions().size(), others);
  EXPECT_LT(others, graph_.transitions.size());
}

TEST_F(GraphTest, RemovingOneTransitionRemovesJustThatOneAlsoWhenItMovesALittle) {
  for (const Transition& meant : graph_.transitions) {
    graph_.removed = {parse_edge(to_string(meant, graph_), graph_)};
    EXPECT_TRUE(graph_.is_removed(meant));
    EXPECT_EQ(graph_.active_transitions().size(), graph_.transitions.size() - 1);
    Transition moved = meant;
    moved.m += graph_.options.separation - 1;
    moved.n -= graph_.options.separation - 1;
    EXPECT_TRUE(graph_.is_removed(moved));
    moved.m += 1;
    EXPECT_FALSE(graph_.is_removed(moved));
  }
}

TEST_F(GraphTest, ParsesEdges) {
  EXPECT_EQ(parse_edge("walk->stroll", graph_),
            (EdgePattern{.source_clip = "walk", .target_clip = "stroll"}));
  EXPECT_EQ(parse_edge(" walk -> walk ", graph_),
            (EdgePattern{.source_clip = "walk", .target_clip = "walk"}));
  EXPECT_EQ(parse_edge("walk:12->stroll:30", graph_),
            (EdgePattern{.source_clip = "walk", .target_clip = "stroll", .m = 12, .n = 30, .within = 6}));
  graph_.clips[0].name = "walk->run";
  EXPECT_EQ(parse_edge("walk->run:3->stroll:4", graph_),
            (EdgePattern{.source_clip = "walk->run", .target_clip = "stroll", .m = 3, .n = 4, .within = 6}));
}

TEST_F(GraphTest, StarsStandForAnyLetters) {
  const auto count = [&](const std::string& text) {
    const EdgePattern pattern = parse_edge(text, graph_);
    return std::ranges::count_if(graph_.transitions,
                                 [&](const Transition& t) { return matches(pattern, t, graph_); });
  };
  const auto of_pair = [&](std::size_t source, std::size_t target) {
    return std::ranges::count_if(graph_.transitions, [&](const Transition& t) {
      return t.source_clip == source && t.target_clip == target;
    });
  };
  EXPECT_EQ(count("*->*"), static_cast<std::ptrdiff_t>(graph_.transitions.size()));
  EXPECT_EQ(count("*->stroll"), of_pair(0, 1) + of_pair(1, 1));
  EXPECT_EQ(count("w*->stroll"), of_pair(0, 1));
  EXPECT_EQ(count("*al*->st*ll"), of_pair(0, 1));
  EXPECT_EQ(count("walk*->walk"), of_pair(0, 0)) << "or for none";
  EXPECT_THAT(argument_error([&] { parse_edge("w*x->stroll", graph_); }),
              HasSubstr("there is no clip 'w*x'; the clips are walk, stroll"));
  EXPECT_THAT(argument_error([&] { parse_edge("*:3->stroll:4", graph_); }), HasSubstr("more than one clip"));
}

TEST_F(GraphTest, ParsesTransitionsToMake) {
  EXPECT_EQ(parse_transition("walk:12->stroll:30", graph_),
            (TransitionRequest{.source_clip = 0, .target_clip = 1, .m = 12, .n = 30}));
  EXPECT_EQ(parse_transition("stroll:12 -> walk:30@8", graph_),
            (TransitionRequest{.source_clip = 1, .target_clip = 0, .m = 12, .n = 30, .half_window = 8}));
  const auto error = [&](const std::string& text) {
    return argument_error([&] { parse_transition(text, graph_); });
  };
  EXPECT_THAT(error("walk->stroll"), HasSubstr("does not say which frames meet"));
  EXPECT_THAT(error("walk:3->stroll"), HasSubstr("does not say which frames meet"));
  EXPECT_THAT(error("*:3->stroll:4"), HasSubstr("there is no clip '*'"));
  EXPECT_THAT(error("walk:3->strol:4"), HasSubstr("did you mean 'stroll'?"));
  EXPECT_THAT(error("walk:50->stroll:4"), HasSubstr("frames 0 to 49, asked for '50'"));
  EXPECT_THAT(error("walk:12@8->stroll:4"), HasSubstr("asked for '12@8'"));
  for (const char* window : {"", "0", "-3", "x", "2.5", "8@9"}) {
    EXPECT_THAT(error(std::string("walk:20->stroll:20@") + window), HasSubstr("at least 1 frame after '@'"))
        << window;
  }
}

TEST_F(GraphTest, ProtectedAndHandMadeStayWhateverRemovesThem) {
  graph_.kept = {graph_.transitions[0]};
  graph_.added = {graph_.transitions[1]};
  graph_.removed = {parse_edge("*->*", graph_)};
  const std::vector<Transition> active = graph_.active_transitions();
  ASSERT_EQ(active.size(), 2U);
  EXPECT_EQ(active[0].m, graph_.transitions[0].m);
  EXPECT_EQ(active[1].m, graph_.transitions[1].m);
  EXPECT_EQ(graph_.edges().size(), graph_.transitions.size()) << "of one place one";
  // Not found any more.
  graph_.transitions.clear();
  EXPECT_EQ(graph_.active_transitions().size(), 2U);
  graph_.removed.clear();
  EXPECT_EQ(graph_.active_transitions().size(), 2U);
}

TEST_F(GraphTest, HandMadeOnesStandBeforeProtectedBeforeFound) {
  Transition kept = graph_.transitions[0];
  kept.half_window = 2;
  Transition added = graph_.transitions[0];
  added.half_window = 3;
  const auto window = [&] {
    for (const GraphEdge& edge : graph_.edges()) {
      if (edge.transition.m == kept.m && edge.transition.n == kept.n &&
          edge.transition.source_clip == kept.source_clip &&
          edge.transition.target_clip == kept.target_clip) {
        return edge.transition.half_window;
      }
    }
    return 0;
  };
  graph_.kept = {kept};
  EXPECT_EQ(window(), 2);
  graph_.added = {added};
  EXPECT_EQ(window(), 3);
  const std::vector<GraphEdge> edges = graph_.edges();
  EXPECT_TRUE(std::ranges::is_sorted(edges, {}, [](const GraphEdge& edge) {
    return std::tuple(edge.transition.source_clip, edge.transition.target_clip, edge.transition.cost);
  }));
}

TEST_F(GraphTest, PruningTakesOutTheEndsButNotWhatIsKept) {
  const auto jump = [](std::size_t source, int leave, std::size_t target, int arrive) {
    return Transition{.source_clip = source, .target_clip = target, .m = leave + 1, .n = arrive - 1};
  };
  // A loop in the first clip; a way out of it that ends; a way in that nothing comes to.
  graph_.transitions = {jump(0, 30, 0, 10), jump(0, 20, 1, 25), jump(1, 5, 0, 12)};
  const auto states = [&] {
    std::vector<GraphEdge::State> result;
    for (const GraphEdge& edge : graph_.edges()) result.push_back(edge.state);
    return result;
  };
  using State = GraphEdge::State;
  using ::testing::ElementsAre;
  EXPECT_THAT(states(), ElementsAre(State::in_force, State::in_force, State::in_force));
  graph_.pruning = Pruning::dead_ends;
  EXPECT_THAT(states(), ElementsAre(State::in_force, State::pruned, State::in_force));
  EXPECT_EQ(graph_.active_transitions().size(), 2U);
  graph_.pruning = Pruning::both_ends;
  EXPECT_THAT(states(), ElementsAre(State::in_force, State::pruned, State::pruned));
  graph_.kept = {graph_.transitions[1]};
  EXPECT_THAT(states(), ElementsAre(State::in_force, State::in_force, State::pruned));
  // Removing the loop leaves nothing that goes on.
  graph_.removed = {parse_edge("walk->walk", graph_)};
  EXPECT_THAT(states(), ElementsAre(State::removed, State::in_force, State::pruned));
}

TEST_F(GraphTest, SaysWhatIsWrongWithAnEdge) {
  const auto error = [&](const std::string& text) {
    return argument_error([&] { parse_edge(text, graph_); });
  };
  EXPECT_THAT(error("walk"), HasSubstr("expected CLIP->CLIP"));
  EXPECT_THAT(error(""), HasSubstr("expected CLIP->CLIP"));
  EXPECT_THAT(error("wlak->stroll"), HasSubstr("did you mean 'walk'?"));
  EXPECT_THAT(error("walk->xyzzyxyzzy"), HasSubstr("the clips are walk, stroll"));
  EXPECT_THAT(error("walk:3->stroll"), HasSubstr("frame of one clip only"));
  EXPECT_THAT(error("walk->stroll:3"), HasSubstr("frame of one clip only"));
  EXPECT_THAT(error("walk:50->stroll:3"), HasSubstr("frames 0 to 49, asked for '50'"));
  EXPECT_THAT(error("walk:5->stroll:-3"), HasSubstr("asked for '-3'"));
  EXPECT_THAT(error("walk:->stroll:3"), HasSubstr("asked for ''"));
  EXPECT_THAT(error("walk:5x->stroll:3"), HasSubstr("asked for '5x'"));
}

TEST_F(GraphTest, SaysWhyItDoesNotFitAnotherDatabase) {
  const auto error = [&](std::vector<MeshSequence> clips) {
    PerformanceDatabase other;
    for (MeshSequence& clip : clips) other.add(std::move(clip));
    return argument_error([&] { check_graph_fits(graph_, other); });
  };
  const MeshSequence walk = database_.clip(0);
  const MeshSequence stroll = database_.clip(1);
  EXPECT_EQ(error({walk, stroll}), "");
  EXPECT_THAT(error({walk}), HasSubstr("it has a clip 'stroll', the database has walk"));
  EXPECT_THAT(error({stroll, walk}), HasSubstr("has the clips walk, stroll, the database has stroll, walk"));
  EXPECT_THAT(error({walk, stroll, test::walk("run", 5)}), HasSubstr("the database has walk, stroll, run"));
  EXPECT_THAT(error({walk, test::walk("stroll", 39)}),
              HasSubstr("its clip 'stroll' has 40 frames at 25 a second, the database's 39"));
  EXPECT_THAT(error({walk, test::walk("stroll", 40, 0.03)}), HasSubstr("other contents of the same clips"));
}

}  // namespace
}  // namespace reprise
