// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <iterator>
#include <string>

#include <nlohmann/json.hpp>

#include "core/base/concat.hpp"
#include "idl/wire/msg/type_description_interfaces.hpp"
#include "idl/wire/type_descriptions.hpp"
#include "server/services/services.hpp"

namespace bpa::server {
namespace {

namespace types = wire::type_description_interfaces;
using Json = nlohmann::json;

types::IndividualTypeDescription individual(const Json& json) {
  types::IndividualTypeDescription type;
  json.at("type_name").get_to(type.type_name);
  for (const Json& of : json.at("fields")) {
    types::Field& field = type.type_fields.emplace_back();
    of.at("name").get_to(field.name);
    of.at("default_value").get_to(field.default_value);
    of.at("type").at("type_id").get_to(field.type.type_id);
    of.at("type").at("capacity").get_to(field.type.capacity);
    of.at("type").at("string_capacity").get_to(field.type.string_capacity);
    of.at("type").at("nested_type_name").get_to(field.type.nested_type_name);
  }
  return type;
}

const wire::TypeDescriptionText* find_type(const std::string& name) {
  const auto found = std::ranges::find(wire::kTypeDescriptions, name,
                                       [](const wire::TypeDescriptionText& t) { return t.name; });
  return found == std::end(wire::kTypeDescriptions) ? nullptr : &*found;
}

/// Why the type cannot be told of; empty if it can.
std::string type_refusal(const wire::TypeDescriptionText* type,
                         const types::GetTypeDescription_Request& request) {
  if (type == nullptr) {
    return concat("this node uses no type ", request.type_name,
                  "; a service's types end with _Request and _Response");
  }
  if (request.type_hash.empty() || request.type_hash == type->hash) return "";
  return concat(request.type_name, " has the hash ", type->hash, " here, not ", request.type_hash);
}

types::GetTypeDescription_Response describe_type(const types::GetTypeDescription_Request& request) {
  types::GetTypeDescription_Response response;
  const wire::TypeDescriptionText* type = find_type(request.type_name);
  response.failure_reason = type_refusal(type, request);
  if (!response.failure_reason.empty()) return response;
  response.successful = true;
  const Json json = Json::parse(type->json);
  types::TypeDescription& description = response.type_description;
  description.type_description = individual(json.at("type_description"));
  for (const Json& one : json.at("referenced_type_descriptions")) {
    description.referenced_type_descriptions.push_back(individual(one));
  }
  if (!request.include_type_sources) return response;
  response.type_sources.push_back({type->name, "idl", type->source});
  for (const types::IndividualTypeDescription& one : description.referenced_type_descriptions) {
    response.type_sources.push_back({one.type_name, "idl", find_type(one.type_name)->source});
  }
  return response;
}

}  // namespace

void add_type_description_service(ServiceSet& services) {
  services.add_quick<types::GetTypeDescription>("~/get_type_description", describe_type);
}

}  // namespace bpa::server
