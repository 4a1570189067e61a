// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

// A user's joint map, and the search for joints among any names: the text, line by line, each line a joint
// whose parent is as many joints before it as its first character says.

#include <algorithm>
#include <cstdint>
#include <cstdlib>
#include <set>
#include <sstream>
#include <string>

#include "reprise/core/error.h"
#include "reprise/retarget/joint_map.h"

namespace {

void require(bool condition) {
  if (!condition) std::abort();
}

reprise::Skeleton skeleton_of(const std::string& text) {
  reprise::Skeleton skeleton;
  std::set<std::string> taken;
  std::istringstream lines(text);
  for (std::string line; std::getline(lines, line) && skeleton.size() < 100;) {
    if (line.size() < 2 || !taken.insert(line.substr(1)).second) continue;
    const int back = static_cast<unsigned char>(line[0]) % 8;
    skeleton.joints.push_back(
        {line.substr(1), std::max(skeleton.size() - 1 - back, -1), Eigen::Vector3d::Zero()});
  }
  return skeleton;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  using namespace reprise;
  const std::string text(reinterpret_cast<const char*>(data), size);
  const Skeleton skeleton = skeleton_of(text);
  try {
    const JointMap found = find_joints(skeleton, "fuzz");
    require(checked(found, skeleton, "fuzz").joints == found.joints);
    require(found.joints.size() + found.missing.size() == body_joints().size());
  } catch (const InvalidArgument&) {
  }
  try {
    const JointMap map = parse_joint_map(text, "fuzz.json");
    for (const auto& [body, theirs] : map.joints) {
      require(std::ranges::find(body_joints(), body) != body_joints().end() && !theirs.empty());
    }
    checked(map, skeleton, "fuzz");
  } catch (const Error&) {
  }
  return 0;
}
