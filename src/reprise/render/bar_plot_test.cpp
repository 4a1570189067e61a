// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include <cmath>

#include <gtest/gtest.h>

#include "reprise/core/error.h"
#include "reprise/io/image_file.h"
#include "reprise/render/plots.h"
#include "support/test_data.h"

namespace reprise {
namespace {

// Bars are a little lighter than the colours of their series.
constexpr Color first = {219, 118, 38};
constexpr Color second = {38, 135, 190};

double count_near(const Image& image, const Color& color) {
  double count = 0.0;
  for (std::size_t i = 0; i < image.rgb.size(); i += 3) {
    bool is_near = true;
    for (std::size_t c = 0; c < 3; ++c) {
      is_near = is_near && std::abs(int{image.rgb[i + c]} - int{color[c]}) <= 6;
    }
    count += is_near ? 1.0 : 0.0;
  }
  return count;
}

TEST(PlotBars, AreasAreTheValues) {
  const test::TemporaryFolder folder;
  const auto drawn = [&](std::vector<double> a, std::vector<double> b, std::vector<double> deviations) {
    plot_bars({.title = "it's",
               .y_label = "cm",
               .columns = {"one", "two"},
               .series = {{.name = "a", .values = std::move(a), .deviations = deviations},
                          {.name = "b", .values = std::move(b), .deviations = deviations}},
               .levels = {{.name = "limit", .value = 10.0, .series_idx = 0}}},
              folder / "bars.png");
    return read_image(folder / "bars.png");
  };
  const Image key = drawn({NAN, NAN}, {NAN, NAN}, {});
  const Image bars = drawn({4.0, NAN}, {2.0, 6.0}, {});
  const double a = count_near(bars, first) - count_near(key, first);
  const double b = count_near(bars, second) - count_near(key, second);
  EXPECT_GT(a, 1000.0);
  EXPECT_NEAR(b / a, 2.0, 0.05);
  // Error bars are drawn over them.
  EXPECT_LT(count_near(drawn({4.0, NAN}, {2.0, 6.0}, {1.0, 1.0}), second), count_near(bars, second));
}

TEST(PlotBars, RefusesWhatIsNoTable) {
  const test::TemporaryFolder folder;
  const auto refuses = [&](const BarPlot& plot) {
    EXPECT_THROW(plot_bars(plot, folder / "none.png"), InvalidArgument);
  };
  refuses({});
  refuses({.columns = {"a"}});
  refuses({.series = {{.name = "a", .values = {}, .deviations = {}}}});
  refuses({.columns = {"a", "b"}, .series = {{.name = "a", .values = {1.0}, .deviations = {}}}});
  refuses({.columns = {"a"}, .series = {{.name = "a", .values = {1.0}, .deviations = {1.0, 2.0}}}});
  EXPECT_FALSE(std::filesystem::exists(folder / "none.png"));
}

}  // namespace
}  // namespace reprise
