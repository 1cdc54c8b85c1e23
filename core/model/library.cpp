// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/model/library.hpp"

#include <algorithm>

#include "core/base/concat.hpp"

namespace bpa {

Status ModelLibrary::add(std::shared_ptr<const ObjectModel> model) {
  for (const auto& other : models_) {
    if (other->name == model->name) {
      return invalid_argument("the library already holds a model named " + model->name);
    }
    if (other->number == model->number) {
      return invalid_argument("model ", model->name, " has the number ", model->number, ", which ",
                              other->name, " has already; numbers must differ");
    }
  }
  models_.insert(std::ranges::lower_bound(models_, model->number, {}, &ObjectModel::number),
                 std::move(model));
  return {};
}

Status ModelLibrary::remove(const std::string& name) {
  if (std::erase_if(models_, [&](const auto& model) { return model->name == name; }) == 0) {
    return Status(StatusCode::not_found, "the library holds no model named " + name);
  }
  return {};
}

std::shared_ptr<const ObjectModel> ModelLibrary::find(const std::string& name) const {
  const auto found = std::ranges::find(models_, name, &ObjectModel::name);
  return found == models_.end() ? nullptr : *found;
}

int ModelLibrary::next_number() const { return models_.empty() ? 1 : models_.back()->number + 1; }

}  // namespace bpa
