// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/pipeline/pose_prior_file.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include <nlohmann/json.hpp>

#include "core/io/file_bytes.hpp"

namespace bpa {
namespace {

using nlohmann::json;

Status corrupt(const std::string& where, const std::string& what) {
  return Status(StatusCode::corrupt, where + ": " + what);
}

Status check_keys(const json& prior, const std::string& where) {
  const std::array<const char*, 7> known{
      "model",   "pose",  "position_sigma_m", "position_covariance_m2", "rotation_sigma_deg",
      "bingham", "weight"};
  for (const auto& [key, value] : prior.items()) {
    if (std::find(known.begin(), known.end(), key) == known.end()) {
      return corrupt(where, "unknown field \"" + key + "\"");
    }
  }
  const auto both = [&prior](const char* a, const char* b) {
    return prior.contains(a) && prior.contains(b);
  };
  if (both("position_sigma_m", "position_covariance_m2")) {
    return corrupt(where, "give position_sigma_m or position_covariance_m2, not both");
  }
  if (both("rotation_sigma_deg", "bingham")) {
    return corrupt(where, "give rotation_sigma_deg or bingham, not both");
  }
  return {};
}

void read_position(const json& prior, PosePrior& out) {
  const bool by_sigma = prior.contains("position_sigma_m");
  if (!by_sigma && !prior.contains("position_covariance_m2")) return;
  const auto t = prior.at("pose").at("translation_m").get<std::array<double, 3>>();
  out.position = align::PositionPrior{{t[0], t[1], t[2]}, Eigen::Matrix3d::Identity()};
  if (by_sigma) {
    const double sigma = prior.at("position_sigma_m").get<double>();
    out.position->covariance *= sigma * sigma;
    return;
  }
  const auto covariance = prior.at("position_covariance_m2").get<std::array<double, 9>>();
  out.position->covariance =
      Eigen::Map<const Eigen::Matrix<double, 3, 3, Eigen::RowMajor>>(covariance.data());
}

void read_orientation(const json& prior, PosePrior& out) {
  if (prior.contains("rotation_sigma_deg")) {
    const double sigma = prior.at("rotation_sigma_deg").get<double>() * M_PI / 180;
    const auto q = prior.at("pose").at("rotation_wxyz").get<std::array<double, 4>>();
    out.orientation = orientation_uncertainty(Eigen::Quaterniond(q[0], q[1], q[2], q[3]),
                                              sigma * sigma * Eigen::Matrix3d::Identity());
  } else if (prior.contains("bingham")) {
    const auto axes = prior.at("bingham").at("axes").get<std::array<double, 12>>();
    const auto c = prior.at("bingham").at("concentrations").get<std::array<double, 3>>();
    out.orientation.axes =
        Eigen::Map<const Eigen::Matrix<double, 4, 3, Eigen::RowMajor>>(axes.data());
    out.orientation.concentrations = {c[0], c[1], c[2]};
  }
}

}  // namespace

Result<std::vector<PosePrior>> read_pose_priors(const std::string& path) {
  const Result<std::string> bytes = io::read_file(path);
  if (!bytes.ok()) return bytes.status();
  const json file = json::parse(*bytes, nullptr, false);
  if (file.is_discarded()) return corrupt(path, "truncated or not JSON");
  std::vector<PosePrior> priors;
  std::string where = path;
  try {
    for (const json& prior : file.at("priors")) {
      where = path + ": priors[" + std::to_string(priors.size()) + "]";
      if (Status status = check_keys(prior, where); !status.ok()) return status;
      PosePrior out;
      out.model = prior.at("model").get<std::string>();
      read_position(prior, out);
      read_orientation(prior, out);
      out.weight = prior.value("weight", out.weight);
      priors.push_back(std::move(out));
    }
  } catch (const json::exception& error) {
    return corrupt(where, std::string("does not have the expected content: ") + error.what());
  }
  return priors;
}

}  // namespace bpa
