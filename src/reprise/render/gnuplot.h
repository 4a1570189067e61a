// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// gnuplot as a program beside this one: scripts and data in a folder of their own, one PNG out.

#pragma once

#include <array>
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <string>
#include <vector>

#include "reprise/core/error.h"

namespace reprise {

// A gnuplot string that nothing is substituted in: between single quotes only the quote itself is special.
// Control characters become question marks.
std::string gnuplot_quoted(const std::string& text);

// The first line of a script that draws a picture of that size, in pixels.
std::string gnuplot_canvas(int width, int height, int font_size);

// Sets the palette Viridis: even steps of value are even steps of lightness.
std::string gnuplot_palette();

// A round step, 1, 2 or 5 times a power of ten, that is `least` (above 0) or more.
double round_step(double least);

// Colours of curves, told apart by people who see no red or no green as well (Okabe and Ito).
inline constexpr std::array gnuplot_colors = {"#d55e00", "#0072b2", "#009e73", "#cc79a7",
                                              "#e69f00", "#56b4e9", "#404040"};

// Data that a script reads, in a temporary folder that goes with the object.
class GnuplotFolder {
 public:
  GnuplotFolder();
  ~GnuplotFolder();
  GnuplotFolder(const GnuplotFolder&) = delete;
  GnuplotFolder& operator=(const GnuplotFolder&) = delete;

  // Raw values, to be read as 'NAME' binary. Throws `FileError` if the disk is full.
  template <typename T>
  void write(const std::string& name, const std::vector<T>& values) const {
    const std::filesystem::path path = path_ / name;
    std::ofstream stream(path, std::ios::binary);
    stream.write(reinterpret_cast<const char*>(values.data()),
                 static_cast<std::streamsize>(values.size() * sizeof(T)));
    stream.close();
    if (!stream) throw FileError(path, "cannot be written: is the disk of temporary files full?");
  }

  // Runs the script here; what it draws becomes `png`, whole or not at all. Throws `Error` if gnuplot is not
  // installed, `FileError` if it fails (with what it said).
  void draw(const std::string& script, const std::filesystem::path& png) const;

 private:
  std::filesystem::path path_;
};

}  // namespace reprise
