// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstdint>
#include <functional>
#include <map>
#include <memory>
#include <string>
#include <string_view>
#include <utility>

#include "core/base/concat.hpp"
#include "core/base/status.hpp"

// Requests and responses of the page, without the library that reads and writes them.

namespace bpa::server::web {

/// An IPv6 address, or an IPv4 address mapped into one.
using Address = std::array<std::uint8_t, 16>;

/// What is known of a request before its body is read.
struct RequestHead {
  std::string method;
  std::string path;                          ///< From '/' to '?'; not decoded.
  std::map<std::string, std::string> query;  ///< Decoded.
  std::string host, origin, fetch_site, authorization;
  std::uint64_t body_bytes = 0;  ///< That the client announces; 0 where it does not say.
  Address address{};             ///< Of the client.

  /// A value of the query; empty without it.
  std::string value(const std::string& name) const {
    const auto found = query.find(name);
    return found == query.end() ? "" : found->second;
  }
};

struct Request : RequestHead {
  std::string body;
};

/// A request target: "/api/results/3?rank=2".
struct Target {
  std::string path;   ///< From '/' to '?'; not decoded.
  std::string query;  ///< What follows '?'; not decoded.
};
/// Splits a target of origin-form (RFC 9112, 3.2.1). Fails with invalid_argument on any other form.
Result<Target> parse_target(std::string_view text);

/// Bytes that several responses may share.
using Bytes = std::shared_ptr<const std::string>;

struct Response {
  int status = 200;
  std::string type = "application/json";
  Bytes body = nullptr;         ///< Null: `fixed` is the body.
  std::string_view fixed = {};  ///< Of the program's own; lives for ever.
  bool zipped = false;          ///< The body is compressed by gzip.
  std::string file_name = {};   ///< Under which a browser saves it; empty: it shows it.
};

inline Response json_response(std::string json, int status = 200) {
  return {.status = status, .body = std::make_shared<const std::string>(std::move(json))};
}
inline Response bytes_response(Bytes bytes, std::string type) {
  return {.type = std::move(type), .body = std::move(bytes)};
}

/// The response that says why there is no other: {"ok": false, "code": ..., "message": ...}.
Response refusal(int status, const Status& why);
/// The same with the HTTP status that fits the code.
Response refusal(const Status& why);

/// Answers one request, once, from any thread, also after the server is gone.
using Responder = std::function<void(Response)>;

/// Who may use a route. A route that declares nothing asks for the token.
enum class Right : std::uint8_t { token, everyone };

/// What serves a request. Access is decided on it, and the request is passed to it.
struct Route {
  Right right = Right::token;
  std::uint64_t max_body = 0;  ///< Bytes.
  /// Runs on the thread of the server and must return soon; it may throw.
  std::function<void(Request&&, Responder)> serve = {};
};

/// A text of a query or a form: "+" is a space, "%41" an A. Nothing where it is malformed.
Result<std::string> url_decoded(std::string_view text);
/// "a=1&b=2". Fails with invalid_argument where a part is malformed or there are too many.
Result<std::map<std::string, std::string>> parse_query(std::string_view text);

}  // namespace bpa::server::web
