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

}  // namespace bpa::eval
