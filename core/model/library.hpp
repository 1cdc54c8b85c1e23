// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <memory>
#include <string>
#include <vector>

#include "core/base/status.hpp"
#include "core/model/object_model.hpp"

namespace bpa {

using Models = std::vector<std::shared_ptr<const ObjectModel>>;

/// The objects that can be detected. Models are immutable and shared. So copying a library, or
/// making one with a model more or fewer, is cheap.
class ModelLibrary {
 public:
  /// Fails with invalid_argument when a model of that name or number is already there.
  Status add(std::shared_ptr<const ObjectModel> model);
  /// Fails with not_found when there is none of that name.
  Status remove(const std::string& name);

  /// nullptr when there is none of that name.
  std::shared_ptr<const ObjectModel> find(const std::string& name) const;
  /// By increasing number.
  const Models& models() const { return models_; }
  bool empty() const { return models_.empty(); }
  int size() const { return static_cast<int>(models_.size()); }
  /// One more than the largest number in use; 1 for an empty library.
  int next_number() const;

 private:
  Models models_;
};

}  // namespace bpa
