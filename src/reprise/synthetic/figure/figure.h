// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// A small procedural performer: a clothed capsule figure with a few clips, made without any outside data.

#pragma once

#include "reprise/database/performance_database.h"

namespace reprise {

struct FigureOptions {
  double frames_per_second = 25.0;
  double height = 1.75;       // metres
  double voxel_size = 0.022;  // metres, the size of the surface's triangles: about 5,500 vertices at 0.022
};

// A database of nine clips of one closed, coloured surface (skin, hair, striped shirt with a belted tunic
// whose hem lags behind the hips, trousers, shoes), 50 to 75 frames each at 25 frames a second:
//   stand       idles; loops
//   walk        three cycles at 1.35 m/s; loops
//   walk_curve  the same, turning left by about a radian
//   jog         three cycles at 2.6 m/s with flight; loops
//   walk_jog    speeds up from walk to jog
//   jog_walk    slows down from jog to walk
//   start       stands, then walks
//   stop        walks, then stands
//   wave        waves the right hand while standing
// Every clip carries its true joints, and the contact of a foot whose whole sole lies still; the surface is
// marked up. Every clip begins at the origin along +Z with Y up. Soles stand still in stance. Lengths and
// speeds scale with the height. Deterministic: the same bytes on any number of threads. Throws
// `InvalidArgument` for a rate outside 5 to 500, a height outside 0.1 to 10 m, or voxels outside 1/437 to
// 1/18 of the height.
PerformanceDatabase make_figure(const FigureOptions& options = {});

}  // namespace reprise
