// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "server/web/http.hpp"

#include <algorithm>
#include <charconv>

#include "server/web/json_text.hpp"

namespace bpa::server::web {
namespace {

/// Values in a query. No request has more than ten.
constexpr std::size_t kMaxQueryValues = 32;

int http_status(StatusCode code) {
  switch (code) {
    case StatusCode::ok:
      return 200;
    case StatusCode::invalid_argument:
    case StatusCode::corrupt:
      return 400;
    case StatusCode::not_found:
      return 404;
    case StatusCode::busy:
    case StatusCode::unavailable:
      return 503;
    case StatusCode::timeout:
      return 504;
    case StatusCode::unsupported:
      return 422;
    case StatusCode::internal:
      return 500;
  }
  return 500;
}

}  // namespace

Response refusal(int status, const Status& why) {
  const nlohmann::json json = {
      {"ok", false}, {"code", to_string(why.code)}, {"message", why.message}};
  return json_response(json_text(json), status);
}

Response refusal(const Status& why) { return refusal(http_status(why.code), why); }

Result<Target> parse_target(std::string_view text) {
  const auto visible = [](unsigned char c) { return c > ' ' && c < 0x7f && c != '#'; };
  if (!text.starts_with('/') || !std::ranges::all_of(text, visible)) {
    return invalid_argument(
        "the request target must be a path that begins with '/', of visible ASCII characters");
  }
  const std::size_t mark = std::min(text.find('?'), text.size());
  return Target{std::string(text.substr(0, mark)),
                std::string(text.substr(std::min(mark + 1, text.size())))};
}

Result<std::string> url_decoded(std::string_view text) {
  std::string out;
  for (std::size_t i = 0; i < text.size(); ++i) {
    if (text[i] != '%') {
      out += text[i] == '+' ? ' ' : text[i];
      continue;
    }
    const std::string_view digits = text.substr(i + 1, 2);
    unsigned byte = 0;
    const auto end = std::from_chars(digits.data(), digits.data() + digits.size(), byte, 16);
    if (digits.size() != 2 || end.ptr != digits.data() + 2) {
      return invalid_argument("\"%", digits, "\" is no encoded byte; it must have two hex digits");
    }
    out += static_cast<char>(byte);
    i += 2;
  }
  return out;
}

Result<std::map<std::string, std::string>> parse_query(std::string_view text) {
  std::map<std::string, std::string> values;
  while (!text.empty()) {
    const std::string_view part = text.substr(0, text.find('&'));
    text.remove_prefix(std::min(part.size() + 1, text.size()));
    const std::size_t equals = part.find('=');
    const auto name = url_decoded(part.substr(0, equals));
    const auto value =
        url_decoded(equals == part.npos ? std::string_view() : part.substr(equals + 1));
    if (!name.ok()) return name.status();
    if (!value.ok()) return value.status();
    values[*name] = *value;
    if (values.size() > kMaxQueryValues) {
      return invalid_argument("the query has more than ", kMaxQueryValues, " values");
    }
  }
  return values;
}

}  // namespace bpa::server::web
