// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/eval/match_names.hpp"

#include <algorithm>

#include "core/io/bop_dataset.hpp"
#include "core/io/model_file.hpp"

namespace bpa::eval {
namespace {

bool named(const ModelNames::value_type& model) {
  return !model.second.empty() && model.second != io::bop_object_name(model.first);
}

template <class T>
std::set<std::string> number_lists(const ModelNames& known,
                                   const std::vector<std::vector<T>*>& lists) {
  ModelNames found;
  for (const auto* list : lists) {
    for (const T& one : *list) found[one.model_number] = one.model;
  }
  const std::map<int, int> numbers = eval::matched(found, known);
  std::set<std::string> lacks;
  for (auto* list : lists) {
    std::erase_if(*list, [&](T& one) {
      const auto number = numbers.find(one.model_number);
      if (number != numbers.end()) one.model_number = number->second;
      if (number != numbers.end() || one.model.empty()) return false;
      lacks.insert(one.model);
      return true;
    });
  }
  return lacks;
}

}  // namespace

std::map<int, int> matched(const ModelNames& from, const ModelNames& to) {
  const bool names = std::ranges::any_of(to, named);
  std::map<int, int> numbers;
  for (const auto& model : from) {
    const auto same = std::ranges::find_if(to, [&](const auto& other) {
      return names && named(model)
                 ? io::clean_model_name(other.second) == io::clean_model_name(model.second)
                 : other.first == model.first;
    });
    if (same != to.end()) numbers[model.first] = same->first;
  }
  return numbers;
}

std::set<std::string> number_by_name(const ModelNames& known,
                                     std::vector<io::FrameResult>& results) {
  std::vector<std::vector<Placement>*> lists;
  for (io::FrameResult& result : results) {
    for (Interpretation& i : result.interpretations) lists.push_back(&i.placements);
  }
  return number_lists(known, lists);
}

std::set<std::string> number_by_name(const ModelNames& known,
                                     std::vector<io::TrackResult>& results) {
  std::vector<std::vector<Track>*> lists;
  for (io::TrackResult& result : results) lists.push_back(&result.tracks);
  return number_lists(known, lists);
}

}  // namespace bpa::eval
