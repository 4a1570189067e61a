// SPDX-FileCopyrightText: 2026 The Reprise authors
// SPDX-License-Identifier: Apache-2.0

#include "reprise/pipeline/motion_corpus.h"

#include <algorithm>
#include <charconv>
#include <map>
#include <optional>
#include <set>
#include <sstream>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "reprise/core/atomic_file.h"
#include "reprise/core/error.h"
#include "reprise/core/text.h"
#include "reprise/io/number.h"

namespace reprise {
namespace {

namespace fs = std::filesystem;

// The fields of a line; none if a quote stays open. "" inside of quotes is one quote.
std::optional<std::vector<std::string>> split_csv(const std::string& line) {
  std::vector<std::string> fields(1);
  bool is_quoted = false;
  for (std::size_t i = 0; i < line.size(); ++i) {
    const char c = line[i];
    if (is_quoted && c == '"' && i + 1 < line.size() && line[i + 1] == '"') {
      fields.back() += '"';
      ++i;
    } else if (c == '"') {
      is_quoted = !is_quoted;
    } else if (c == ',' && !is_quoted) {
      fields.emplace_back();
    } else {
      fields.back() += c;
    }
  }
  if (is_quoted) return std::nullopt;
  return fields;
}

class IndexReader {
 public:
  explicit IndexReader(const fs::path& path) : path_(path) {}

  std::vector<CorpusTrial> read() {
    std::istringstream text(read_text_file(path_));
    std::vector<CorpusTrial> corpus;
    std::set<std::string> names;
    std::string line;
    while (std::getline(text, line)) {
      ++line_;
      if (!line.empty() && line.back() == '\r') line.pop_back();
      if (line.empty()) continue;
      const auto fields = split_csv(line);
      if (!fields) fail("a quote is opened and not closed");
      if (columns_.empty()) {
        read_head(*fields);
        continue;
      }
      if (fields->size() != column_count_) {
        fail(fmt::format("expected {} fields, as the head row has, found {}", column_count_, fields->size()));
      }
      corpus.push_back(make_trial(*fields));
      if (!names.insert(corpus.back().trial).second) {
        fail(fmt::format("trial '{}' is listed twice", corpus.back().trial));
      }
    }
    if (corpus.empty()) throw FileError(path_, "lists no trials");
    return corpus;
  }

 private:
  [[noreturn]] void fail(const std::string& what) const {
    throw FileError(path_, fmt::format("line {}", line_), what);
  }

  void read_head(const std::vector<std::string>& fields) {
    for (std::size_t i = 0; i < fields.size(); ++i) columns_[fields[i]] = i;
    column_count_ = fields.size();
    if (columns_.contains("trial")) return;
    fail(fmt::format("expected a head row with a column 'trial', found {}", fmt::join(fields, ", ")));
  }

  std::string field(const std::vector<std::string>& fields, const char* column) const {
    const auto found = columns_.find(column);
    return found == columns_.end() ? std::string() : fields[found->second];
  }

  double number(const std::vector<std::string>& fields, const char* column, double otherwise) const {
    const std::string text = field(fields, column);
    if (text.empty()) return otherwise;
    double value = 0.0;
    const char* const end = text.data() + text.size();
    if (parse_double(text.data(), end, value) != end || !(value > 0.0 && value < 1e9)) {
      fail(fmt::format("{}: expected a positive number, found '{}'", column, text));
    }
    return value;
  }

  CorpusTrial make_trial(const std::vector<std::string>& fields) const {
    CorpusTrial trial{.trial = field(fields, "trial"),
                      .motion_class = field(fields, "class"),
                      .description = field(fields, "description"),
                      .tier = field(fields, "tier"),
                      .frames = static_cast<std::size_t>(number(fields, "frames", 0.0)),
                      .flags = field(fields, "flags")};
    if (trial.trial.empty() || trial.trial.find_first_of("/:") != std::string::npos) {
      fail(fmt::format("'{}' is no name of a trial", trial.trial));
    }
    std::string subject = field(fields, "subject");
    if (subject.empty()) subject = trial.trial.substr(0, trial.trial.find('_'));
    const fs::path folder = path_.parent_path();
    const fs::path amc = folder / "amc" / (trial.trial + ".amc");
    const fs::path bvh = folder / "bvh" / (trial.trial + ".bvh");
    if (fs::exists(amc)) {
      trial.source.motion = amc;
      trial.source.skeleton = folder / "asf" / (subject + ".asf");
      if (columns_.contains("fps")) trial.source.frames_per_second = number(fields, "fps", 120.0);
    } else if (fs::exists(bvh)) {
      trial.source.motion = bvh;
    } else {
      fail(fmt::format("there is neither {} nor {}", amc.string(), bvh.string()));
    }
    return trial;
  }

  const fs::path& path_;
  std::map<std::string, std::size_t> columns_;
  std::size_t column_count_ = 0;
  int line_ = 0;
};

void check_names(const std::vector<std::string>& asked, const std::vector<std::string>& known,
                 const char* what) {
  for (const std::string& name : asked) {
    if (std::ranges::count(known, name) > 0) continue;
    const std::string nearest = nearest_word(name, known);
    throw InvalidArgument(
        nearest.empty() ? fmt::format("the corpus has no {} '{}'", what, name)
                        : fmt::format("the corpus has no {} '{}'; did you mean '{}'?", what, name, nearest));
  }
}

}  // namespace

std::vector<CorpusTrial> read_corpus(const fs::path& index) {
  return IndexReader(index).read();
}

std::vector<CorpusTrial> chosen_trials(std::vector<CorpusTrial> corpus, const std::vector<std::string>& tiers,
                                       const std::vector<std::string>& trials) {
  std::vector<std::string> known_tiers;
  std::vector<std::string> known_trials;
  for (const CorpusTrial& trial : corpus) {
    known_trials.push_back(trial.trial);
    if (std::ranges::count(known_tiers, trial.tier) == 0) known_tiers.push_back(trial.tier);
  }
  check_names(tiers, known_tiers, "tier");
  check_names(trials, known_trials, "trial");
  std::erase_if(corpus, [&](const CorpusTrial& trial) {
    return (!tiers.empty() && std::ranges::count(tiers, trial.tier) == 0) ||
           (!trials.empty() && std::ranges::count(trials, trial.trial) == 0);
  });
  if (corpus.empty()) throw InvalidArgument("none of these trials is in these tiers");
  return corpus;
}

}  // namespace reprise
