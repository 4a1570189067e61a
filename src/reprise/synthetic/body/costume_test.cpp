// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/synthetic/body/costume.h"

#include <fstream>
#include <functional>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "reprise/core/error.h"
#include "support/test_data.h"

namespace reprise {
namespace {

using testing::AllOf;
using testing::HasSubstr;

std::string message_of(const std::function<void()>& call) {
  try {
    call();
  } catch (const Error& error) {
    return error.what();
  }
  return "no error";
}

TEST(Costume, BuiltInOnesShowOneWomanInThreeDresses) {
  EXPECT_THAT(builtin_costume_names(), testing::ElementsAre("character1", "fashion1", "fashion2"));
  const Costume first = load_costume("character1");
  for (const std::string& name : builtin_costume_names()) {
    const Costume costume = load_costume(name);
    EXPECT_EQ(costume.name, name);
    EXPECT_EQ(costume.body, first.body);
    EXPECT_EQ(costume.skin, first.skin);
    EXPECT_EQ(costume.eye_color, first.eye_color);
    EXPECT_FALSE(costume.garments.empty());
    bool has_pattern = false, is_simulated = false;
    for (const CostumeGarment& garment : costume.garments) {
      has_pattern = has_pattern || garment.pattern.kind != CostumePattern::Kind::plain;
      is_simulated = is_simulated || garment.freedom.most > 0.0;
    }
    EXPECT_TRUE(has_pattern) << name;
    EXPECT_TRUE(is_simulated) << name;
  }
  EXPECT_EQ(first.motions, "character");
  EXPECT_EQ(load_costume("fashion2").motions, "fashion2");
}

TEST(Costume, AFileMayChangeSomeFieldsOfAnother) {
  const test::TemporaryFolder folder;
  std::ofstream(folder / "red.json") << R"({"based_on": "fashion1", "name": "red",
      "hair": {"proxy": "bob01", "color": "#102030"}})";
  std::ofstream(folder / "redder.json") << R"({"based_on": "red.json", "name": "redder", "eyebrows": "x"})";
  const Costume base = load_costume("fashion1");
  const Costume red = load_costume((folder / "redder.json").string());
  EXPECT_EQ(red.name, "redder");
  EXPECT_EQ(red.eyebrows, "x");
  EXPECT_EQ(red.hair.proxy, "bob01");
  EXPECT_EQ(red.hair.color, (Color{0x10, 0x20, 0x30}));
  EXPECT_EQ(red.hair.freedom.most, 0.0);  // of this hair, not of the base's
  EXPECT_EQ(red.motions, base.motions);
  EXPECT_EQ(red.garments.size(), base.garments.size());
}

TEST(Costume, UnknownNamesAreOfferedTheNearest) {
  EXPECT_THAT(message_of([] { load_costume("fashion3"); }), HasSubstr("did you mean 'fashion1'?"));
  EXPECT_THAT(message_of([] { load_costume("nowhere/x.json"); }), HasSubstr("nowhere/x.json"));
}

TEST(Costume, WhatIsWrongIsNamedWithItsPlace) {
  struct Case {
    std::string text;
    std::vector<std::string> expected;
  };
  const std::vector<Case> cases = {
      {"{", {"byte"}},
      {"222e22222", {"expected JSON", "222e22222"}},  // beyond what a number may be
      {"[]", {"expected a JSON object"}},
      {R"({"name": "x"})", {"'motions'", "based_on"}},
      {R"({"based_on": "fashion9"})", {"based_on", "did you mean 'fashion1'?"}},
      {R"({"based_on": "c.json"})", {"based_on", "not based on this one"}},
      {R"({"based_on": "fashion1", "garmets": []})", {"'garmets'", "did you mean 'garments'?"}},
      {R"({"based_on": "fashion1", "motions": "fashon1"})",
       {"motions", "'fashon1'", "did you mean 'fashion1'?"}},
      {R"({"based_on": "fashion1", "skin": 3})", {"skin", "expected a text", "found 3"}},
      {R"({"based_on": "fashion1", "body": {"a": 20}})", {"body.a", "from -2 to 2", "found 20"}},
      {R"({"based_on": "fashion1", "hair": {"color": "#000000"}})", {"hair", "proxy"}},
      {R"({"based_on": "fashion1", "hair": {"proxy": "bob01", "color": "red"}})",
       {"hair.color", "\"#c8452f\""}},
      {R"({"based_on": "fashion1", "garments": [{"proxy": "A"}, {"color": "#000000"}]})", {"garments[1]"}},
      {R"({"based_on": "fashion1", "garments": [{"proxy": "A", "hem": 0.5}]})", {"garments[0]", "waist"}},
      {R"({"based_on": "fashion1", "garments": [{"proxy": "A", "hem": 1, "waist": 0.5}]})", {"garments[0]"}},
      {R"({"based_on": "fashion1", "garments": [{"proxy": "A", "pieces": "uper"}]})",
       {"garments[0].pieces", "did you mean 'upper'?"}},
      {R"({"based_on": "fashion1", "garments": [{"proxy": "A", "freedom": {"from": 0.5, "to": 0.9}}]})",
       {"garments[0].freedom", "below it"}},
      {R"({"based_on": "fashion1", "garments": [{"proxy": "A", "pattern": {"type": "strips"}}]})",
       {"garments[0].pattern.type", "did you mean 'stripes'?"}},
      {R"({"based_on": "fashion1", "garments": [{"proxy": "A", "pattern": {"type": "dots"}}]})",
       {"garments[0].pattern", "two or more"}},
  };
  for (const Case& wrong : cases) {
    SCOPED_TRACE(wrong.text);
    const std::string message = message_of([&] { parse_costume(wrong.text, "c.json"); });
    EXPECT_THAT(message, HasSubstr("c.json"));
    for (const std::string& expected : wrong.expected) EXPECT_THAT(message, HasSubstr(expected));
  }
}

}  // namespace
}  // namespace reprise
