// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/io/pose_prior_file.hpp"

#include <cmath>
#include <set>

#include "core/io/private/json_file.hpp"

namespace bpa::io {
namespace {

Status check_keys(const Json& prior, const std::string& where) {
  const std::set<std::string> known{
      "model",   "pose",  "position_sigma_m", "position_covariance_m2", "rotation_sigma_deg",
      "bingham", "weight"};
  for (const auto& [key, value] : prior.items()) {
    if (!known.contains(key)) return corrupt(where, ": unknown field \"", key, "\"");
  }
  const std::pair<const char*, const char*> alternatives[] = {
      {"position_sigma_m", "position_covariance_m2"}, {"rotation_sigma_deg", "bingham"}};
  for (const auto& [one, other] : alternatives) {
    if (prior.contains(one) && prior.contains(other)) {
      return corrupt(where, ": give ", one, " or ", other, ", not both");
    }
  }
  return {};
}

PosePrior prior_from(const Json& json) {
  PosePrior prior;
  json.at("model").get_to(prior.model);
  prior.weight = json.value("weight", prior.weight);
  const bool by_sigma = json.contains("position_sigma_m");
  if (by_sigma || json.contains("position_covariance_m2")) {
    prior.position.emplace();
    json.at("pose").at("translation_m").get_to(prior.position->mean);
  }
  if (by_sigma) {
    const double sigma = json.at("position_sigma_m").get<double>();
    prior.position->covariance *= sigma * sigma;
  } else if (prior.position) {
    json.at("position_covariance_m2").get_to(prior.position->covariance);
  }
  if (json.contains("rotation_sigma_deg")) {
    const double sigma = json.at("rotation_sigma_deg").get<double>() * M_PI / 180;
    const auto q = json.at("pose").at("rotation_wxyz").get<Eigen::Vector4d>();
    prior.orientation = orientation_uncertainty(Eigen::Quaterniond(q[0], q[1], q[2], q[3]),
                                                sigma * sigma * Eigen::Matrix3d::Identity());
  } else if (json.contains("bingham")) {
    json.at("bingham").at("axes").get_to(prior.orientation.axes);
    json.at("bingham").at("concentrations").get_to(prior.orientation.concentrations);
  }
  return prior;
}

// `where` says in which prior a problem is.
Result<std::vector<PosePrior>> priors_from(const Json& file, std::string& where) {
  const std::string name = where;
  std::vector<PosePrior> priors;
  for (const Json& json : file.at("priors")) {
    where = concat(name, ": priors[", priors.size(), "]");
    if (Status status = check_keys(json, where); !status.ok()) return status;
    priors.push_back(prior_from(json));
  }
  return priors;
}

}  // namespace

Result<std::vector<PosePrior>> read_pose_priors(const std::string& path) {
  if (path.empty()) return std::vector<PosePrior>();
  std::string where = path;
  return read_json(where, [&](const Json& file) { return priors_from(file, where); });
}

Result<std::vector<PosePrior>> parse_pose_priors(const std::string& text, std::string name) {
  return with_json(name, [&] { return priors_from(Json::parse(text), name); });
}

}  // namespace bpa::io
