// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/retarget/joint_guess.h"

#include <algorithm>
#include <array>
#include <cctype>
#include <span>
#include <string_view>
#include <vector>

namespace reprise::retargeting {
namespace {

enum class Side { none, left, right };

// A name taken apart: "mixamorig:LeftUpLeg" is the left "upleg".
struct Name {
  Side side = Side::none;
  std::string word;  // all letters, lower case, without the side
};

bool is_upper(char c) {
  return std::isupper(static_cast<unsigned char>(c)) != 0;
}
bool is_letter(char c) {
  return std::isalpha(static_cast<unsigned char>(c)) != 0;
}
char lower(char c) {
  return static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
}

std::vector<std::string> words_of(std::string_view name) {
  std::vector<std::string> words(1);
  for (std::size_t i = 0; i < name.size(); ++i) {
    const bool begins = is_upper(name[i]) && i > 0 && !is_upper(name[i - 1]);
    if (!is_letter(name[i]) || begins) words.emplace_back();
    if (is_letter(name[i])) words.back() += lower(name[i]);
  }
  std::erase(words, std::string());
  return words;
}

struct Vocabulary {
  std::string_view word;
  // How well the word fits each of the four joints of a limb, from the trunk outwards; 0: not at all.
  std::array<int, 4> fits;
};

// Of several words that a name contains, the first counts.
constexpr std::array<Vocabulary, 16> leg_words = {{{"upperleg", {3, 0, 0, 0}},
                                                   {"upleg", {3, 0, 0, 0}},
                                                   {"thigh", {3, 0, 0, 0}},
                                                   {"femur", {3, 0, 0, 0}},
                                                   {"lowerleg", {0, 3, 0, 0}},
                                                   {"lowleg", {0, 3, 0, 0}},
                                                   {"shin", {0, 3, 0, 0}},
                                                   {"calf", {0, 3, 0, 0}},
                                                   {"tibia", {0, 3, 0, 0}},
                                                   {"knee", {0, 3, 0, 0}},
                                                   {"leg", {1, 2, 0, 0}},
                                                   {"hip", {2, 0, 0, 0}},
                                                   {"ankle", {0, 0, 3, 0}},
                                                   {"toe", {0, 0, 0, 3}},
                                                   {"foot", {0, 0, 2, 1}},
                                                   {"ball", {0, 0, 0, 2}}}};
constexpr std::array<Vocabulary, 16> arm_words = {{{"forearm", {0, 0, 3, 0}},
                                                   {"lowerarm", {0, 0, 3, 0}},
                                                   {"lowarm", {0, 0, 3, 0}},
                                                   {"radius", {0, 0, 3, 0}},
                                                   {"elbow", {0, 0, 3, 0}},
                                                   {"upperarm", {0, 3, 0, 0}},
                                                   {"uparm", {0, 3, 0, 0}},
                                                   {"humerus", {0, 3, 0, 0}},
                                                   {"shldr", {1, 2, 0, 0}},
                                                   {"collar", {3, 0, 0, 0}},
                                                   {"clavicle", {3, 0, 0, 0}},
                                                   {"scapula", {2, 0, 0, 0}},
                                                   {"shoulder", {1, 2, 0, 0}},
                                                   {"wrist", {0, 0, 0, 3}},
                                                   {"hand", {0, 0, 0, 2}},
                                                   {"arm", {0, 2, 1, 0}}}};
// Names that stand for something beside the limb itself.
constexpr std::array<std::string_view, 15> other_words = {"twist",  "roll",  "thumb", "index", "middle",
                                                          "finger", "pinky", "ring",  "eye",   "pole",
                                                          "target", "ctrl",  "ik",    "nub",   "jaw"};

bool contains(const std::string& text, std::string_view word) {
  return text.find(word) != std::string::npos;
}

bool is_known(const std::string& word) {
  const auto begins = [&](const Vocabulary& entry) { return word.starts_with(entry.word); };
  return std::ranges::any_of(leg_words, begins) || std::ranges::any_of(arm_words, begins);
}

Name taken_apart(const std::string& name) {
  Name result;
  for (std::string word : words_of(std::string_view(name).substr(name.rfind(':') + 1))) {
    if (word == "l" || word == "left") {
      result.side = Side::left;
    } else if (word == "r" || word == "right") {
      result.side = Side::right;
    } else {
      // "lfemur", "leftarm": a side written before a word that would be known without it.
      for (const auto& [mark, side] : {std::pair<std::string_view, Side>{"left", Side::left},
                                       {"right", Side::right},
                                       {"l", Side::left},
                                       {"r", Side::right}}) {
        if (result.side == Side::none && word.starts_with(mark) && !is_known(word) &&
            is_known(word.substr(mark.size()))) {
          result.side = side;
          word.erase(0, mark.size());
        }
      }
      result.word += word;
    }
  }
  return result;
}

std::array<int, 4> fits(const Name& name, std::span<const Vocabulary> words) {
  if (std::ranges::any_of(other_words, [&](std::string_view other) { return contains(name.word, other); })) {
    return {};
  }
  const auto found =
      std::ranges::find_if(words, [&](const Vocabulary& entry) { return contains(name.word, entry.word); });
  return found == words.end() ? std::array<int, 4>{} : found->fits;
}

class Guess {
 public:
  explicit Guess(const Skeleton& skeleton) : skeleton_(skeleton) {
    for (const Joint& joint : skeleton.joints) names_.push_back(taken_apart(joint.name));
  }

  // The four joints of a limb, -1 where there is none, such that each lies below the one before it and the
  // words fit best.
  std::array<int, 4> limb(Side side, std::span<const Vocabulary> words) const;
  bool is_below(int joint, int ancestor) const;
  int common_ancestor(int a, int b) const;
  // The joint with that word that is nearest to the root, or -1. It has no side.
  int first_with(std::string_view word) const;

 private:
  const Skeleton& skeleton_;
  std::vector<Name> names_;
};

bool Guess::is_below(int joint, int ancestor) const {
  while (joint > ancestor) joint = skeleton_.joints[static_cast<std::size_t>(joint)].parent;
  return joint == ancestor;
}

int Guess::common_ancestor(int a, int b) const {
  while (a >= 0 && !is_below(b, a)) a = skeleton_.joints[static_cast<std::size_t>(a)].parent;
  return a;
}

int Guess::first_with(std::string_view word) const {
  for (std::size_t j = 0; j < names_.size(); ++j) {
    if (names_[j].side == Side::none && contains(names_[j].word, word)) return static_cast<int>(j);
  }
  return -1;
}

std::array<int, 4> Guess::limb(Side side, std::span<const Vocabulary> words) const {
  // The best chain that ends at joint j as limb joint k: its score, and the joint and place before it.
  struct Chain {
    int score = 0;
    int joint = -1, place = -1;
  };
  std::vector<std::array<Chain, 4>> best(names_.size());
  Chain end;
  for (std::size_t j = 0; j < names_.size(); ++j) {
    if (names_[j].side != side) continue;
    const std::array<int, 4> fit = fits(names_[j], words);
    for (std::size_t k = 0; k < 4; ++k) {
      if (fit[k] == 0) continue;
      Chain& chain = best[j][k];
      for (int a = skeleton_.joints[j].parent; a >= 0;
           a = skeleton_.joints[static_cast<std::size_t>(a)].parent) {
        for (std::size_t before = 0; before < k; ++before) {
          const Chain& other = best[static_cast<std::size_t>(a)][before];
          if (other.score > chain.score) chain = {other.score, a, static_cast<int>(before)};
        }
      }
      chain.score += fit[k];
      if (chain.score > end.score) end = {chain.score, static_cast<int>(j), static_cast<int>(k)};
    }
  }
  std::array<int, 4> joints = {-1, -1, -1, -1};
  for (int j = end.joint, k = end.place; j >= 0;) {
    joints[static_cast<std::size_t>(k)] = j;
    const Chain& chain = best[static_cast<std::size_t>(j)][static_cast<std::size_t>(k)];
    j = chain.joint;
    k = chain.place;
  }
  return joints;
}

}  // namespace

std::map<std::string, std::string> guess_joints(const Skeleton& skeleton) {
  const Guess guess(skeleton);
  std::map<std::string, std::string> result;
  const auto put = [&](const std::string& body_joint, int joint) {
    if (joint >= 0) result[body_joint] = skeleton.joints[static_cast<std::size_t>(joint)].name;
  };
  std::array<std::array<int, 4>, 2> legs{}, arms{};
  for (const std::size_t side : {std::size_t{0}, std::size_t{1}}) {
    const std::string name = side == 0 ? "left_" : "right_";
    legs[side] = guess.limb(side == 0 ? Side::left : Side::right, leg_words);
    arms[side] = guess.limb(side == 0 ? Side::left : Side::right, arm_words);
    constexpr std::array<const char*, 4> leg_joints = {"thigh", "shin", "foot", "toe"};
    constexpr std::array<const char*, 4> arm_joints = {"collar", "upper_arm", "forearm", "hand"};
    for (std::size_t k = 0; k < 4; ++k) {
      put(name + leg_joints[k], legs[side][k]);
      put(name + arm_joints[k], arms[side][k]);
    }
  }
  if (legs[0][0] < 0 || legs[1][0] < 0) return result;
  const int pelvis = guess.common_ancestor(legs[0][0], legs[1][0]);
  put("pelvis", pelvis);
  int head = guess.first_with("head");
  if (head <= pelvis || !guess.is_below(head, pelvis)) head = -1;
  put("head", head);
  int chest = -1;
  if (arms[0][1] >= 0 && arms[1][1] >= 0) chest = guess.common_ancestor(arms[0][1], arms[1][1]);
  if (chest == pelvis || chest == head || (head >= 0 && !guess.is_below(head, chest))) chest = -1;
  put("chest", chest);
  // From the chest down to the pelvis: the lowest joint between is the spine; from the head down to the chest
  // the lowest is the neck.
  const auto lowest_between = [&](int below, int above) {
    int lowest = -1;
    if (below < 0 || above < 0 || !guess.is_below(above, below)) return lowest;
    for (int j = skeleton.joints[static_cast<std::size_t>(above)].parent; j > below;
         j = skeleton.joints[static_cast<std::size_t>(j)].parent) {
      lowest = j;
    }
    return lowest;
  };
  put("spine", lowest_between(pelvis, chest));
  put("neck", lowest_between(chest, head));
  return result;
}

}  // namespace reprise::retargeting
