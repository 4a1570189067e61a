// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// A process alone; what several ranks do together is tested under `mpirun` (tests/cli/ranks_test.sh).

#include "reprise/core/ranks.h"

#include <algorithm>
#include <array>

#include <gtest/gtest.h>

#include "reprise/core/error.h"

namespace reprise {
namespace {

void expect_alone() {
  EXPECT_EQ(Ranks::index(), 0);
  EXPECT_EQ(Ranks::count(), 1);
  EXPECT_TRUE(Ranks::is_first());
  const std::array bytes = {std::byte{3}, std::byte{0}, std::byte{7}};
  const auto all = Ranks::all_gather(bytes);
  ASSERT_EQ(all.size(), 1U);
  EXPECT_TRUE(std::ranges::equal(all[0], bytes));
  EXPECT_EQ(Ranks::all_gather({}).size(), 1U) << "nothing is a contribution, too";
  EXPECT_TRUE(Ranks::all_failed()) << "nobody is left waiting";
}

TEST(RanksTest, WithoutALauncherThereIsOne) {
  expect_alone();
  {
    const Ranks ranks;
    expect_alone();
  }
  expect_alone();
}

TEST(RanksTest, AreMadeOnceAProcess) {
  const Ranks ranks;
  EXPECT_THROW(Ranks(), InvalidArgument);
}

}  // namespace
}  // namespace reprise
