// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/render/gnuplot.h"

#include <cmath>
#include <cstdlib>

#include <fmt/format.h>

#include "reprise/core/atomic_file.h"
#include "reprise/render/child_process.h"

namespace reprise {

namespace fs = std::filesystem;

std::string gnuplot_quoted(const std::string& text) {
  std::string result = "'";
  for (const char c : text) {
    if (static_cast<unsigned char>(c) < 0x20 || c == 0x7f) {
      result += '?';
    } else {
      result += c == '\'' ? "''" : std::string(1, c);
    }
  }
  return result + "'";
}

std::string gnuplot_canvas(int width, int height, int font_size) {
  return fmt::format(
      "set terminal pngcairo truecolor noenhanced size {},{} font 'DejaVu Sans,{}' background rgb 'white'\n",
      width, height, font_size);
}

std::string gnuplot_palette() {
  return "set palette maxcolors 0 defined (0 '#440154', 0.125 '#472d7b', 0.25 '#3b528b', 0.375 '#2c728e', "
         "0.5 "
         "'#21918c', 0.625 '#28ae80', 0.75 '#5ec962', 0.875 '#addc30', 1 '#fde725')\n";
}

double round_step(double least) {
  const double power = std::pow(10.0, std::floor(std::log10(least)));
  for (const double factor : {1.0, 2.0, 5.0}) {
    if (factor * power >= least) return factor * power;
  }
  return 10.0 * power;
}

GnuplotFolder::GnuplotFolder() {
  std::string pattern = (fs::temp_directory_path() / "reprise-plot-XXXXXX").string();
  if (mkdtemp(pattern.data()) == nullptr) throw FileError(pattern, "the temporary folder cannot be made");
  path_ = pattern;
}

GnuplotFolder::~GnuplotFolder() {
  std::error_code ignored;
  fs::remove_all(path_, ignored);
}

void GnuplotFolder::draw(const std::string& script, const fs::path& png) const {
  write_text_file(path_ / "plot.gp", script);
  AtomicOutput output(png, AtomicOutput::Kind::file);
  // -d: without the user's own start-up files. The picture comes on standard output, so that its name needs
  // no quoting.
  ChildProcess gnuplot({"gnuplot", "-d", "plot.gp"},
                       {.output = fs::absolute(output.path()), .working_directory = path_},
                       "to draw plots (on Debian: apt install gnuplot-nox)");
  const bool ended_well = gnuplot.finish();
  std::error_code ignored;
  const auto written = fs::file_size(output.path(), ignored);
  if (!ended_well || ignored || written == 0) {
    throw FileError(png, fmt::format("cannot be drawn: {}", gnuplot.report()));
  }
  output.commit();
}

}  // namespace reprise
