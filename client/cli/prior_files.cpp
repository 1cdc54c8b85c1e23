// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "client/cli/prior_files.hpp"

#include <algorithm>
#include <cmath>
#include <fstream>

#include <nlohmann/json.hpp>

namespace bpa::cli {
namespace {

using Json = nlohmann::json;

constexpr double kRadians = 3.14159265358979323846 / 180;

Status corrupt(const std::string& where, const std::string& what) {
  return Status(StatusCode::corrupt, where + ": " + what);
}

Status check_keys(const Json& prior, const std::string& where) {
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

void read_position(const Json& prior, ExpectedPose& out) {
  const bool by_sigma = prior.contains("position_sigma_m");
  if (!by_sigma && !prior.contains("position_covariance_m2")) return;
  prior.at("pose").at("translation_m").get_to(out.camera_from_object.position);
  if (!by_sigma) {
    prior.at("position_covariance_m2").get_to(out.position_covariance);
    return;
  }
  const double sigma = prior.at("position_sigma_m").get<double>();
  for (std::size_t i = 0; i < 3; ++i) out.position_covariance[4 * i] = sigma * sigma;
}

/// The unit vector at right angles to three orthonormal ones (the columns): what is left of the
/// longest of the four basis vectors' parts outside them.
std::array<double, 4> mode_of(const std::array<std::array<double, 4>, 3>& axes) {
  std::array<double, 4> best{};
  double longest = -1;
  for (std::size_t k = 0; k < 4; ++k) {
    std::array<double, 4> rest{};
    rest[k] = 1;
    for (const auto& axis : axes) {
      for (std::size_t i = 0; i < 4; ++i) rest[i] -= axis[k] * axis[i];
    }
    double squared = 0;
    for (const double x : rest) squared += x * x;
    if (squared <= longest) continue;
    longest = squared;
    for (std::size_t i = 0; i < 4; ++i) best[i] = rest[i] / std::sqrt(squared);
  }
  return best;
}

void read_orientation(const Json& prior, ExpectedPose& out) {
  std::array<double, 4>& orientation = out.camera_from_object.orientation;
  if (prior.contains("rotation_sigma_deg")) {
    const auto q = prior.at("pose").at("rotation_wxyz").get<std::array<double, 4>>();
    orientation = {{q[1], q[2], q[3], q[0]}};
    out.orientation_spread =
        spread_about(orientation, prior.at("rotation_sigma_deg").get<double>() * kRadians);
  } else if (prior.contains("bingham")) {
    const auto axes = prior.at("bingham").at("axes").get<std::array<double, 12>>();
    for (std::size_t i = 0; i < 12; ++i) out.orientation_spread.axes[i % 3][i / 3] = axes[i];
    prior.at("bingham").at("concentrations").get_to(out.orientation_spread.concentrations);
    const auto mode = mode_of(out.orientation_spread.axes);
    orientation = {{mode[1], mode[2], mode[3], mode[0]}};
  }
}

}  // namespace

Result<std::vector<ExpectedPose>> read_priors(const std::string& path) {
  std::vector<ExpectedPose> priors;
  if (path.empty()) return priors;
  std::ifstream file(path);
  if (!file) return Status(StatusCode::not_found, path + ": there is no such file");
  const Json json = Json::parse(file, nullptr, false);
  if (json.is_discarded()) return corrupt(path, "not JSON");
  std::string where = path;
  try {
    for (const Json& prior : json.at("priors")) {
      where = path + ": priors[" + std::to_string(priors.size()) + "]";
      if (Status status = check_keys(prior, where); !status.ok()) return status;
      ExpectedPose out;
      prior.at("model").get_to(out.model);
      read_position(prior, out);
      read_orientation(prior, out);
      out.weight = prior.value("weight", out.weight);
      priors.push_back(std::move(out));
    }
  } catch (const std::exception& error) {
    return corrupt(where, error.what());
  }
  return priors;
}

}  // namespace bpa::cli
