// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include <algorithm>
#include <cmath>
#include <cstdlib>
#include <fstream>

#include <fmt/format.h>

#include "reprise/core/atomic_file.h"
#include "reprise/core/error.h"
#include "reprise/core/parallel.h"
#include "reprise/render/child_process.h"
#include "reprise/render/plots.h"

namespace reprise {
namespace {

namespace fs = std::filesystem;

constexpr double canvas_width = 1400.0;
constexpr double canvas_height = 1250.0;
constexpr std::size_t side = 1040;  // of the square plot, pixels
constexpr double left = 170.0;
constexpr double bottom = 135.0;
constexpr double letter_width = 9.0;  // of a clip name, pixels

class ScratchFolder {
 public:
  ScratchFolder() {
    std::string pattern = (fs::temp_directory_path() / "reprise-plot-XXXXXX").string();
    if (mkdtemp(pattern.data()) == nullptr) throw FileError(pattern, "the temporary folder cannot be made");
    path_ = pattern;
  }
  ~ScratchFolder() {
    std::error_code ignored;
    fs::remove_all(path_, ignored);
  }
  ScratchFolder(const ScratchFolder&) = delete;
  ScratchFolder& operator=(const ScratchFolder&) = delete;
  const fs::path& path() const { return path_; }

 private:
  fs::path path_;
};

// A gnuplot string that nothing is substituted in: between single quotes only the quote itself is special.
std::string quoted(const std::string& text) {
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

// The frames that one pixel of the plot stands for: [first, last).
struct PixelFrames {
  std::size_t first = 0;
  std::size_t last = 0;
};

PixelFrames frames_of_pixel(std::size_t pixel, std::size_t frame_count) {
  const std::size_t first = pixel * frame_count / side;
  return {first, std::max(first + 1, (pixel + 1) * frame_count / side)};
}

// Values as the plot shows them, one a pixel, rows top to bottom. Drawn pixel for pixel: gnuplot would leave
// seams between frames, or blur them.
std::vector<float> raster(const DissimilarityMatrix& matrix) {
  std::vector<float> values(side * side);
  parallel_for(0, side, [&](std::size_t row) {
    const PixelFrames rows = frames_of_pixel(row, matrix.frame_count());
    for (std::size_t column = row; column < side; ++column) {
      const PixelFrames columns = frames_of_pixel(column, matrix.frame_count());
      float least = INFINITY;
      for (std::size_t a = rows.first; a < rows.last; ++a) {
        for (std::size_t b = columns.first; b < columns.last; ++b)
          least = std::min(least, matrix.value(a, b));
      }
      values[row * side + column] = least;
      values[column * side + row] = least;
    }
  });
  return values;
}

template <typename T>
void write_binary(const fs::path& path, const std::vector<T>& values) {
  std::ofstream stream(path, std::ios::binary);
  stream.write(reinterpret_cast<const char*>(values.data()),
               static_cast<std::streamsize>(values.size() * sizeof(T)));
  stream.close();
  if (!stream) throw FileError(path, "cannot be written: is the disk of temporary files full?");
}

// 1, 2 or 5 times a power of ten, so that ticks lie at least about 45 pixels apart.
int tick_step(double pixels_per_frame) {
  const double least = 45.0 / pixels_per_frame;
  const double power = std::pow(10.0, std::floor(std::log10(std::max(least, 1.0))));
  for (const double factor : {1.0, 2.0, 5.0, 10.0}) {
    if (factor * power >= least) return static_cast<int>(factor * power);
  }
  return static_cast<int>(10.0 * power);
}

std::string axis_script(const DissimilarityMatrix& matrix) {
  const auto frame_count = static_cast<double>(matrix.frame_count());
  const double pixels_per_frame = side / frame_count;
  const int step = tick_step(pixels_per_frame);
  const auto& names = matrix.clip_names();
  const auto& counts = matrix.clip_frame_counts();
  bool names_fit = true;
  for (std::size_t c = 0; c < names.size(); ++c) {
    const double wanted = letter_width * static_cast<double>(names[c].size()) + 10.0;
    names_fit = names_fit && wanted <= pixels_per_frame * static_cast<double>(counts[c]);
  }

  std::string script;
  std::string ticks;
  double last_name_position = -1e9;
  for (std::size_t c = 0; c < names.size(); ++c) {
    const auto first = static_cast<double>(matrix.first_frame(c));
    const auto count = static_cast<double>(counts[c]);
    // Ticks count the frames of each clip, as in "clip:frame"; none so near to the next clip that its 0 would
    // touch.
    for (int tick = 0; tick < static_cast<int>(counts[c]); tick += step) {
      const bool has_room = tick == 0 ? count * pixels_per_frame > 14.0 : tick + 0.6 * step <= count;
      if (has_room) ticks += fmt::format("{}'{}' {}", ticks.empty() ? "" : ", ", tick, first + tick);
    }
    if (c > 0) {
      script += fmt::format(
          "set arrow from {0},graph 0 to {0},graph 1 nohead front lw 1.2 lc rgb '#66ffffff'\n", first);
      script += fmt::format(
          "set arrow from graph 0,first {0} to graph 1,first {0} nohead front lw 1.2 lc rgb '#66ffffff'\n",
          first);
    }
    // A clip too thin for a line of text of its own goes unnamed rather than unreadable.
    const double middle = first + 0.5 * count;
    if ((middle - last_name_position) * pixels_per_frame < 13.0) continue;
    last_name_position = middle;
    const std::string name = quoted(names[c]);
    script +=
        fmt::format("set label {} at {},graph 0 offset character 0,-2.1 {} font ',12' tc rgb '#202020'\n",
                    name, middle, names_fit ? "center" : "right rotate by 38");
    script += fmt::format(
        "set label {} at graph 0,first {} right offset character -5.2,0 font ',12' tc rgb '#202020'\n", name,
        middle);
  }
  script += fmt::format("set xtics out nomirror scale 0.5 font ',9' offset 0,0.35 ({0})\n", ticks);
  script += fmt::format("set ytics out nomirror scale 0.5 font ',9' offset 0.5,0 ({0})\n", ticks);
  return script;
}

std::vector<double> transition_points(const DissimilarityMatrix& matrix,
                                      const std::vector<Transition>& transitions) {
  const auto& counts = matrix.clip_frame_counts();
  std::vector<double> points;
  for (const Transition& t : transitions) {
    const bool fits = t.source_clip < counts.size() && t.target_clip < counts.size() && t.m >= 0 &&
                      t.n >= 0 && static_cast<std::size_t>(t.m) < counts[t.source_clip] &&
                      static_cast<std::size_t>(t.n) < counts[t.target_clip];
    if (!fits) {
      throw InvalidArgument(fmt::format(
          "transitions: clip {} frame {} -> clip {} frame {} lies outside of the matrix of {} clips",
          t.source_clip, t.m, t.target_clip, t.n, counts.size()));
    }
    points.push_back(static_cast<double>(matrix.first_frame(t.target_clip)) + t.n + 0.5);
    points.push_back(static_cast<double>(matrix.first_frame(t.source_clip)) + t.m + 0.5);
  }
  return points;
}

}  // namespace

void plot_matrix(const DissimilarityMatrix& matrix, const std::vector<Transition>& transitions,
                 const fs::path& png) {
  const std::size_t frame_count = matrix.frame_count();
  if (frame_count == 0) throw InvalidArgument("matrix: has no frame to plot");
  const std::vector<double> points = transition_points(matrix, transitions);

  const ScratchFolder folder;
  const std::vector<float> values = raster(matrix);
  write_binary(folder.path() / "matrix.bin", values);
  write_binary(folder.path() / "transitions.bin", points);
  float largest = 0.0F;
  for (const float value : values) {
    if (std::isfinite(value)) largest = std::max(largest, value);
  }

  std::string script = fmt::format(
      "set terminal pngcairo truecolor noenhanced size {},{} font 'DejaVu Sans,13' background rgb 'white'\n",
      canvas_width, canvas_height);
  script += fmt::format(
      "set lmargin at screen {}\nset rmargin at screen {}\nset bmargin at screen {}\nset tmargin at screen "
      "{}\n",
      left / canvas_width, (left + side) / canvas_width, bottom / canvas_height,
      (bottom + side) / canvas_height);
  script +=
      fmt::format("set title {} font ',16' offset 0,-0.3\n",
                  quoted(fmt::format("Dissimilarity of all pairs of frames ({} metric)", matrix.metric())));
  // Viridis: even steps of value are even steps of lightness.
  script +=
      "set palette maxcolors 0 defined (0 '#440154', 0.125 '#472d7b', 0.25 '#3b528b', 0.375 '#2c728e', 0.5 "
      "'#21918c', "
      "0.625 '#28ae80', 0.75 '#5ec962', 0.875 '#addc30', 1 '#fde725')\n";
  script += fmt::format("set xrange [0:{0}]\nset yrange [{0}:0]\nset cbrange [0:{1}]\n", frame_count,
                        largest > 0.0F ? largest : 1.0F);
  script += fmt::format("set colorbox user origin {},{} size {},{}\n", (left + side + 25.0) / canvas_width,
                        bottom / canvas_height, 28.0 / canvas_width, side / canvas_height);
  script += "set cblabel 'dissimilarity (m)' font ',13' offset 0.8,0\nset cbtics font ',11' scale 0.5\n";
  script += "set border 15 lw 1 lc rgb '#404040' front\nunset key\nset style line 1 lw 0\n";
  script += "set label 'target frame' at graph 0.5,screen 0.018 center font ',13'\n";
  script += "set label 'source frame' at screen 0.018,graph 0.5 center rotate by 90 font ',13'\n";
  script += axis_script(matrix);
  // An image is placed by the centre of its first pixel.
  const double pixel = static_cast<double>(frame_count) / side;
  script += fmt::format(
      "plot 'matrix.bin' binary array=({0},{0}) format='%float32' origin=({1},{1}) dx={2} dy={2} with image",
      side, 0.5 * pixel, pixel);
  if (!points.empty()) {
    const char* source =
        "'transitions.bin' binary record=({}) format='%float64%float64' using 1:2 with points pt 7";
    const std::string data = fmt::format(fmt::runtime(source), transitions.size());
    script += fmt::format(
        ", {0} ps 1.25 lc rgb '#303030', {0} ps 1.05 lc rgb '#ffd21a', {0} ps 0.5 lc rgb '#fffbe0'", data);
  }
  script += "\n";
  write_text_file(folder.path() / "plot.gp", script);

  AtomicOutput output(png, AtomicOutput::Kind::file);
  // -d: without the user's own start-up files. The picture comes on standard output, so that its name needs
  // no quoting.
  ChildProcess gnuplot({"gnuplot", "-d", "plot.gp"},
                       {.output = fs::absolute(output.path()), .working_directory = folder.path()},
                       "to plot matrices (on Debian: apt install gnuplot-nox)");
  const bool ended_well = gnuplot.finish();
  std::error_code ignored;
  const auto written = fs::file_size(output.path(), ignored);
  if (!ended_well || ignored || written == 0) {
    throw FileError(png, fmt::format("the matrix cannot be plotted: {}", gnuplot.report()));
  }
  output.commit();
}

}  // namespace reprise
