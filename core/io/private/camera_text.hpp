// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "core/io/private/json_file.hpp"

namespace bpa::io {

/// Numbers and what stands between them in lists. Nothing for another text.
std::optional<std::vector<double>> bare_numbers(std::string text);

/// The content of a camera file as JSON: of JSON, YAML, OpenCV's XML, ini, or bare numbers.
Result<Json> json_of_text(const std::string& path, std::string text);

}  // namespace bpa::io
