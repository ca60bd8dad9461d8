#include "config/reading/strict/key_table.h"

#include <algorithm>
#include <deque>
#include <iterator>
#include <stdexcept>
#include <string_view>
#include <utility>

#include "config/reading/strict/reader.h"

namespace osteon::config {
namespace {

// the recorder of this thread while RecordKeys runs; otherwise null
thread_local KeyRecorder* present_recorder = nullptr;

constexpr std::size_t kMaxRuns = 5000;  // number of runs of a loader after which RecordKeys fails

using Keys = std::set<std::string>;

Keys Intersection(const Keys& a, const Keys& b) {
  Keys common;
  std::ranges::set_intersection(a, b, std::inserter(common, common.end()));
  return common;
}

// The table of a place such as "zones[]."; created if it does not exist.
KeyTable& TableAt(KeyTable& table, const std::string& place) {
  KeyTable* at = &table;
  for (std::size_t begin = 0; begin < place.size();) {
    const std::size_t dot = place.find('.', begin);
    std::string key = place.substr(begin, dot - begin);
    if (key.ends_with("[]")) key.resize(key.size() - 2);
    at = &at->inner[key];
    begin = dot + 1;
  }
  return *at;
}

}  // namespace

KeyRecorder* KeyRecorder::Present() { return present_recorder; }

std::size_t KeyRecorder::Decide(const std::string& question, std::size_t answers) {
  asked_.emplace_back(question, answers);
  const auto answer = answers_.find(question);
  return answer == answers_.end() ? 0 : std::min(answer->second, answers - 1);
}

void KeyRecorder::Note(const std::string& place, const std::string& key, KeyInfo info) {
  run_.mappings[place].keys.insert_or_assign(key, std::move(info));
}

bool KeyRecorder::NoteOptional(const std::string& place, const std::string& key) {
  const bool is_there = Decide("has " + place + key, 2) == 0;
  run_.mappings[place].optional[key] = is_there;
  return is_there;
}

void KeyRecorder::Choose(const std::string& place, const std::string& key, bool is_there) {
  answers_["has " + place + key] = is_there ? 0 : 1;
  run_.mappings[place].optional[key] = is_there;
}

void KeyRecorder::NoteWord(const std::string& place, const std::string& key, const std::string& word) {
  run_.mappings[place].words[key] = word;
}

void KeyRecorder::Finish(const std::string& place) {
  for (auto& [inner, mapping] : run_.mappings)
    if (inner.starts_with(place)) mapping.finished = true;
  if (place.empty()) throw Ended{};
}

namespace {

using Answers = std::map<std::string, std::size_t>;

// All keys that a loader asked for in a mapping.
Keys KnownIn(const KeyRecorder::Mapping& mapping) {
  Keys known;
  for (const auto& [key, ignored] : mapping.keys) known.insert(key);
  return known;
}

// The keys that a loader read in a mapping without first asking whether they are present.
Keys NeededIn(const KeyRecorder::Mapping& mapping) {
  Keys needed;
  for (const auto& [key, ignored] : mapping.keys)
    if (!mapping.optional.contains(key)) needed.insert(key);
  return needed;
}

// Adds the keys of a run's mappings to the table. Removes from `required` the keys that this run does not
// require.
void AddKeys(const KeyRecorder::Run& run, std::map<std::string, Keys>& required, KeyTable& table) {
  for (const auto& [place, mapping] : run.mappings) {
    KeyTable& table_at_place = TableAt(table, place);
    for (const auto& [key, info] : mapping.keys) {
      KeyInfo& known = table_at_place.keys.try_emplace(key, info).first->second;
      if (known.type == KeyInfo::Type::kAny) known = info;
      known.min = std::min(known.min, info.min);  // the range may differ between runs: keep the widest
      known.max = std::max(known.max, info.max);
      if (known.size != info.size) known.size = 0;
    }
    if (!mapping.finished) continue;
    // optional keys that the loader asked for but did not read
    for (const auto& [key, is_there] : mapping.optional)
      if (is_there) table_at_place.keys.try_emplace(key, KeyInfo{.type = KeyInfo::Type::kAny});
    const Keys needed = NeededIn(mapping);
    const auto [all, is_first] = required.try_emplace(place, needed);
    if (!is_first) all->second = Intersection(all->second, needed);
  }
}

// Adds the cases of one key: for each word of the key, the keys that depend on this word.
// @param runs  the notes on the mapping from several runs, which differ only in the word of this key
void AddCases(const std::string& place, const std::string& key,
              const std::vector<const KeyRecorder::Mapping*>& runs, KeyTable& table) {
  Keys somewhere, everywhere = KnownIn(*runs.front()), always = NeededIn(*runs.front());
  for (const KeyRecorder::Mapping* run : runs) {
    somewhere.merge(KnownIn(*run));
    everywhere = Intersection(everywhere, KnownIn(*run));
    always = Intersection(always, NeededIn(*run));
  }
  // The case of a word: keys that occur only with other words are excluded, and keys that this word needs but
  // not every word needs are required.
  for (const KeyRecorder::Mapping* run : runs) {
    KeyCase one{.key = key, .word = run->words.at(key), .required = {}, .excluded = {}};
    const Keys known = KnownIn(*run), needed = NeededIn(*run);
    std::ranges::set_difference(somewhere, known, std::inserter(one.excluded, one.excluded.end()));
    std::ranges::set_difference(needed, always, std::inserter(one.required, one.required.end()));
    if (!one.required.empty() || !one.excluded.empty()) TableAt(table, place).cases.push_back(std::move(one));
  }
}

}  // namespace

KeyTable RecordKeys(const std::function<void(const std::filesystem::path&)>& load) {
  if (present_recorder) throw std::logic_error("config: RecordKeys inside another");
  std::deque<Answers> waiting{{}};  // answers of the runs that are still to be made
  // pairs of question and answer that were already queued
  std::set<std::pair<std::string, std::size_t>> tried;
  std::set<Answers> seen{{}};  // sets of answers that were queued because a run did not end
  std::vector<KeyRecorder::Run> runs;
  // Runs the loader once with these answers. Appends to `runs`; returns the questions that were asked.
  const auto record = [&](const Answers& answers) {
    KeyRecorder recorder;
    recorder.answers_ = answers;
    present_recorder = &recorder;
    try {
      load("recorded.yaml");
    } catch (const KeyRecorder::Ended&) {
    } catch (const std::exception&) {  // the loader refused these answers, because they contradict each other
    }
    present_recorder = nullptr;
    runs.push_back(std::move(recorder.run_));
    return std::move(recorder.asked_);
  };
  constexpr std::string_view kChoice = "choice ";
  // For each question about a key's word, from a run that ended: the answers of that run, and the number of
  // words.
  std::map<std::string, std::pair<Answers, std::size_t>> choices;
  while (!waiting.empty()) {
    if (runs.size() == kMaxRuns) throw std::logic_error("config: a loader asks without end");
    const Answers answers = std::move(waiting.front());
    waiting.pop_front();
    const auto asked = record(answers);
    const bool ended = runs.back().mappings.contains("") && runs.back().mappings.at("").finished;
    // If a run did not end, the answer to its last question probably contradicts the earlier answers: try all
    // answers to it.
    if (!ended && !asked.empty())
      for (std::size_t answer = 0; answer < asked.back().second; ++answer) {
        Answers other = answers;
        other[asked.back().first] = answer;
        if (seen.insert(other).second) waiting.push_back(std::move(other));
      }
    for (const auto& [question, count] : asked) {
      if (ended && question.starts_with(kChoice)) choices.try_emplace(question, answers, count);
      for (std::size_t answer = 1; answer < count; ++answer)
        if (tried.emplace(question, answer).second) {
          waiting.push_back(answers);
          waiting.back()[question] = answer;
        }
    }
  }

  // For each key with words, run the loader once per word, with all other answers unchanged. The differences
  // between these runs show which keys depend on the word.
  KeyTable table;
  for (const auto& [question, choice] : choices) {
    const std::size_t dot = question.rfind('.');
    const std::string key = question.substr(dot == std::string::npos ? kChoice.size() : dot + 1);
    const std::string place = question.substr(kChoice.size(), question.size() - kChoice.size() - key.size());
    const std::size_t first = runs.size();
    for (std::size_t answer = 0; answer < choice.second; ++answer) {
      Answers answers = choice.first;
      answers[question] = answer;
      static_cast<void>(record(answers));
    }
    std::vector<const KeyRecorder::Mapping*> mappings_of_place;
    for (std::size_t i = first; i < runs.size(); ++i)
      if (const auto at = runs[i].mappings.find(place); at != runs[i].mappings.end() && at->second.finished)
        mappings_of_place.push_back(&at->second);
    if (mappings_of_place.size() > 1) AddCases(place, key, mappings_of_place, table);
  }
  std::map<std::string, Keys> required;  // keys that every run requires, by place
  for (const KeyRecorder::Run& run : runs) AddKeys(run, required, table);
  for (const KeyRecorder::Run& run : runs)
    for (const auto& [place, ignored] : run.mappings)
      for (auto& [key, info] : TableAt(table, place).keys)
        info.required = required[place].contains(key);  // false if no run reached the end of the mapping
  return table;
}

}  // namespace osteon::config
