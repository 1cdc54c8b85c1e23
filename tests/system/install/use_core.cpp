// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <iostream>

#include <bpa/core/cloud/frame.hpp>
#include <bpa/core/model/library.hpp>

// An empty library and an empty frame, each refused or told as what it is.
int main() {
  const bpa::ModelLibrary library;
  const bpa::Status status = bpa::validate(bpa::Frame{});
  std::cout << library.size() << " models, frame: " << status.message << '\n';
  return library.empty() && !status.ok() ? 0 : 1;
}
