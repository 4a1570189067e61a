// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/graph/graph_components.h"

#include <algorithm>
#include <map>
#include <numeric>
#include <random>
#include <set>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "reprise/core/error.h"

namespace reprise {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;
using Kind = ClipPart::Kind;

// Leaves `source` at frame `leave`, arrives in `target` at frame `arrive`.
Transition jump(std::size_t source, int leave, std::size_t target, int arrive) {
  return {.source_clip = source, .target_clip = target, .m = leave + 1, .n = arrive - 1, .half_window = 1};
}

// What is true of each frame, from the definition: every frame a node, reachability by exhaustion.
class BruteForce {
 public:
  BruteForce(const std::vector<int>& frame_counts, const std::vector<Transition>& transitions) {
    int count = 0;
    for (const int frames : frame_counts) {
      first_.push_back(count);
      count += frames;
    }
    reaches_.assign(static_cast<std::size_t>(count), std::vector<bool>(static_cast<std::size_t>(count)));
    for (std::size_t clip = 0; clip < frame_counts.size(); ++clip) {
      for (int f = 0; f + 1 < frame_counts[clip]; ++f) reaches_[node(clip, f)][node(clip, f + 1)] = true;
    }
    for (const Transition& t : transitions) {
      reaches_[node(t.source_clip, t.leave())][node(t.target_clip, t.arrive())] = true;
    }
    for (std::size_t via = 0; via < reaches_.size(); ++via) {
      for (auto& from : reaches_) {
        if (!from[via]) continue;
        for (std::size_t to = 0; to < reaches_.size(); ++to) from[to] = from[to] || reaches_[via][to];
      }
    }
  }

  std::size_t node(std::size_t clip, int frame) const {
    return static_cast<std::size_t>(first_[clip] + frame);
  }
  std::size_t size() const { return reaches_.size(); }
  bool reaches(std::size_t from, std::size_t to) const { return reaches_[from][to]; }
  bool is_core(std::size_t a) const { return reaches(a, a); }
  bool are_together(std::size_t a, std::size_t b) const { return reaches(a, b) && reaches(b, a); }
  bool goes_on(std::size_t a) const {
    for (std::size_t b = 0; b < size(); ++b) {
      if (is_core(b) && (a == b || reaches(a, b))) return true;
    }
    return false;
  }
  bool comes_from(std::size_t a) const {
    for (std::size_t b = 0; b < size(); ++b) {
      if (is_core(b) && (a == b || reaches(b, a))) return true;
    }
    return false;
  }

 private:
  std::vector<int> first_;
  std::vector<std::vector<bool>> reaches_;
};

void expect_as_by_brute_force(const std::vector<int>& frame_counts,
                              const std::vector<Transition>& transitions) {
  const BruteForce brute(frame_counts, transitions);
  const GraphComponents found = find_components(frame_counts, transitions);

  // Every frame stands in one part, in order, and the part says what is true of it.
  std::vector<std::optional<std::size_t>> component(brute.size());
  std::size_t next = 0;
  for (const ClipPart& part : found.parts) {
    for (int f = part.range.first; f <= part.range.last; ++f, ++next) {
      const std::size_t node = brute.node(part.range.clip_idx, f);
      ASSERT_EQ(node, next);
      component[node] = part.component;
      const Kind expected = brute.is_core(node)       ? Kind::core
                            : !brute.comes_from(node) ? (brute.goes_on(node) ? Kind::lead_in : Kind::apart)
                            : brute.goes_on(node)     ? Kind::passage
                                                      : Kind::lead_out;
      EXPECT_EQ(part.kind, expected) << "clip " << part.range.clip_idx << " frame " << f;
      EXPECT_EQ(part.component.has_value(), expected == Kind::core);
    }
  }
  EXPECT_EQ(next, brute.size());

  // Two frames are of one component if each is reached from the other.
  for (std::size_t a = 0; a < brute.size(); ++a) {
    for (std::size_t b = 0; b < brute.size(); ++b) {
      if (!component[a] || !component[b]) continue;
      EXPECT_EQ(component[a] == component[b], brute.are_together(a, b));
    }
  }
  std::size_t last_size = brute.size();
  for (std::size_t c = 0; c < found.components.size(); ++c) {
    const GraphComponent& own = found.components[c];
    std::set<std::size_t> clips;
    std::size_t size = 0;
    for (const FrameRange& range : own.ranges) {
      EXPECT_TRUE(clips.insert(range.clip_idx).second) << "one range a clip";
      for (int f = range.first; f <= range.last; ++f, ++size) {
        EXPECT_EQ(component[brute.node(range.clip_idx, f)], c);
      }
    }
    EXPECT_EQ(std::ranges::count(component, std::optional(c)), static_cast<std::ptrdiff_t>(size));
    EXPECT_LE(size, last_size) << "most frames first";
    last_size = size;

    const std::size_t here = brute.node(own.ranges.front().clip_idx, own.ranges.front().first);
    std::vector<std::size_t> inside;
    for (std::size_t i = 0; i < transitions.size(); ++i) {
      const Transition& t = transitions[i];
      if (component[brute.node(t.source_clip, t.leave())] == c &&
          component[brute.node(t.target_clip, t.arrive())] == c) {
        inside.push_back(i);
      }
    }
    EXPECT_EQ(own.transitions, inside);
    std::set<std::size_t> reached;
    for (std::size_t node = 0; node < brute.size(); ++node) {
      if (component[node] && component[node] != c && brute.reaches(here, node))
        reached.insert(*component[node]);
    }
    EXPECT_EQ(own.leads_to, std::vector<std::size_t>(reached.begin(), reached.end()));
  }

  for (std::size_t i = 0; i < transitions.size(); ++i) {
    const Transition& t = transitions[i];
    EXPECT_EQ(found.goes_on[i], brute.goes_on(brute.node(t.target_clip, t.arrive())));
    EXPECT_EQ(found.comes_from[i], brute.comes_from(brute.node(t.source_clip, t.leave())));
  }
}

TEST(GraphComponents, AreThoseOfBruteForce) {
  std::mt19937 random(3);
  const auto below = [&](int end) { return std::uniform_int_distribution<int>(0, end - 1)(random); };
  std::map<std::size_t, int> seen;
  for (int graph = 0; graph < 400; ++graph) {
    std::vector<int> frame_counts(static_cast<std::size_t>(1 + below(4)));
    for (int& frames : frame_counts) frames = 3 + below(12);
    std::vector<Transition> transitions;
    for (int i = below(9); i > 0; --i) {
      const auto clip = [&] {
        return static_cast<std::size_t>(below(static_cast<int>(frame_counts.size())));
      };
      const std::size_t source = clip();
      const std::size_t target = clip();
      transitions.push_back(
          jump(source, below(frame_counts[source] - 2), target, 2 + below(frame_counts[target] - 2)));
    }
    expect_as_by_brute_force(frame_counts, transitions);
    ++seen[find_components(frame_counts, transitions).components.size()];
    if (HasFailure()) FAIL() << "graph " << graph;
  }
  EXPECT_GE(seen.size(), 4U) << "the graphs must differ in their number of components";
}

TEST(GraphComponents, AnArrivalAfterTheLastDepartureIsADeadEnd) {
  const std::vector<int> frame_counts = {20, 20};
  // Both clips lead to each other, but in the second a walk arrives too late to leave again.
  const std::vector<Transition> late = {jump(0, 10, 1, 15), jump(1, 14, 0, 5)};
  GraphComponents found = find_components(frame_counts, late);
  EXPECT_THAT(found.components, IsEmpty());
  EXPECT_THAT(found.goes_on, ElementsAre(false, false));

  const std::vector<Transition> in_time = {jump(0, 10, 1, 14), jump(1, 14, 0, 5)};
  found = find_components(frame_counts, in_time);
  ASSERT_EQ(found.components.size(), 1U);
  EXPECT_THAT(found.components[0].ranges, ElementsAre(FrameRange{0, 5, 10}, FrameRange{1, 14, 14}));
  EXPECT_THAT(found.components[0].transitions, ElementsAre(0U, 1U));
  ASSERT_EQ(found.parts.size(), 6U);
  EXPECT_EQ(found.parts[0].kind, Kind::lead_in);
  EXPECT_EQ(found.parts[1].kind, Kind::core);
  EXPECT_EQ(found.parts[2].kind, Kind::lead_out);
}

TEST(GraphComponents, OneComponentMayLeadToAnother) {
  const std::vector<int> frame_counts = {30, 30};
  const std::vector<Transition> transitions = {jump(0, 20, 0, 10), jump(0, 15, 1, 5), jump(1, 25, 1, 8)};
  const GraphComponents found = find_components(frame_counts, transitions);
  ASSERT_EQ(found.components.size(), 2U);
  EXPECT_THAT(found.components[0].ranges, ElementsAre(FrameRange{1, 8, 25}));
  EXPECT_THAT(found.components[0].leads_to, IsEmpty());
  EXPECT_THAT(found.components[1].leads_to, ElementsAre(0U));
  EXPECT_THAT(found.parts, ::testing::Contains(::testing::Field(&ClipPart::kind, Kind::passage)));
}

TEST(GraphComponents, WithoutTransitionsEveryWalkEnds) {
  const std::vector<int> frame_counts = {4, 1};
  const GraphComponents found = find_components(frame_counts, {});
  EXPECT_THAT(found.components, IsEmpty());
  ASSERT_EQ(found.parts.size(), 2U);
  EXPECT_EQ(found.parts[0].range, (FrameRange{0, 0, 3}));
  EXPECT_EQ(found.parts[0].kind, Kind::apart);
  EXPECT_THAT(find_components({}, {}).parts, IsEmpty());
}

TEST(GraphComponents, AreFoundInLongChainsWithoutDeepRecursion) {
  constexpr int count = 100'000;
  std::vector<int> frame_counts(count, 4);
  std::vector<Transition> transitions;
  for (std::size_t c = 0; c < count; ++c) transitions.push_back(jump(c, 2, (c + 1) % count, 2));
  const GraphComponents found = find_components(frame_counts, transitions);
  ASSERT_EQ(found.components.size(), 1U);
  EXPECT_EQ(found.components[0].ranges.size(), static_cast<std::size_t>(count));
}

TEST(GraphComponents, RefuseTransitionsThatDoNotFit) {
  const std::vector<int> frame_counts = {10, 5};
  const auto refuses = [&](const Transition& t) {
    EXPECT_THROW(find_components(frame_counts, std::vector{t}), InvalidArgument);
  };
  refuses(jump(0, 3, 2, 3));
  refuses(jump(2, 3, 0, 3));
  refuses(jump(0, -1, 1, 3));
  refuses(jump(0, 10, 1, 3));
  refuses(jump(0, 3, 1, 5));
}

}  // namespace
}  // namespace reprise
