// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "idl/wire/names.hpp"

#include <algorithm>

namespace bpa::wire {
namespace {

// 255 in DDS less the longest prefix and suffix, as rmw counts it.
constexpr std::size_t kMaxNameLength = 247;

constexpr std::string_view kDigits = "0123456789";
constexpr std::string_view kLegal =
    "_abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789";

/// What is wrong with one token of a name; null if nothing is.
const char* token_error(std::string_view token) {
  if (token.empty()) return "must not have two slashes in a row or end in one";
  if (kDigits.find(token[0]) != kDigits.npos) return "must not have a digit at the start of a part";
  if (token.find("__") != std::string_view::npos) return "must not have two underscores in a row";
  return token.find_first_not_of(kLegal) == token.npos
             ? nullptr
             : "must have letters, digits, underscores and slashes only";
}

std::string join(const std::string& parent, std::string_view child) {
  return (parent == "/" ? "" : parent) + "/" + std::string(child);
}

Result<std::string> expand(std::string_view name, const NodeName& node) {
  std::string full;
  if (!name.empty() && name[0] == '/') {
    full = name;
  } else if (name.substr(0, 2) == "~/") {
    full = join(node.full(), name.substr(2));
  } else if (name == "~") {
    full = node.full();
  } else {
    full = join(node.node_namespace, name);
  }
  if (Status s = validate_full_name(full); !s.ok()) return s;
  return full;
}

}  // namespace

std::string dds_topic_name(std::string_view full_name) { return "rt" + std::string(full_name); }

std::string dds_request_topic_name(std::string_view full_name) {
  return "rq" + std::string(full_name) + "Request";
}

std::string dds_reply_topic_name(std::string_view full_name) {
  return "rr" + std::string(full_name) + "Reply";
}

std::string dds_type_name(std::string_view type) {
  std::string name;
  const std::size_t last = type.rfind('/');
  for (std::size_t i = 0; i < type.size(); ++i) {
    if (type[i] != '/') name += type[i];
    if (type[i] == '/') name += "::";
    if (i == last) name += "dds_::";
  }
  return name + "_";
}

Status validate_full_name(std::string_view name) {
  const auto broken = [&name](const char* rule) {
    return invalid_argument("name '" + std::string(name) + "' " + rule);
  };
  if (name.empty() || name[0] != '/') return broken("must start with a slash");
  if (name.size() > kMaxNameLength) return broken("must not be longer than 247 characters");
  for (std::size_t begin = 1; begin <= name.size();) {
    const std::size_t end = std::min(name.find('/', begin), name.size());
    if (const char* error = token_error(name.substr(begin, end - begin))) return broken(error);
    begin = end + 1;
  }
  return {};
}

Result<Remap> parse_remap(std::string_view text) {
  const std::size_t at = text.find(":=");
  if (at == std::string_view::npos || at == 0 || at + 2 == text.size()) {
    return invalid_argument("remap '" + std::string(text) + "' must read from:=to");
  }
  return Remap{std::string(text.substr(0, at)), std::string(text.substr(at + 2))};
}

std::string NodeName::full() const { return join(node_namespace, name); }

Result<std::string> resolve_name(std::string_view name, const NodeName& node,
                                 const std::vector<Remap>& remaps) {
  Result<std::string> full = expand(name, node);
  if (!full.ok()) return full;
  for (const Remap& remap : remaps) {
    Result<std::string> from = expand(remap.from, node);
    if (!from.ok()) return from;
    if (*from == *full) return expand(remap.to, node);
  }
  return full;
}

}  // namespace bpa::wire
