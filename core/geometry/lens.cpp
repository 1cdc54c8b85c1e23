// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/geometry/lens.hpp"

#include <cctype>
#include <cmath>

#include "core/base/concat.hpp"

namespace bpa {
namespace {

struct Model {
  const char* names;  ///< Letters and digits alone.
  std::size_t coefficients;
  bool equidistant;
};

constexpr std::size_t kMaxDistortion = 8;

constexpr Model kModels[] = {{" plumbbob radtan brownconrady distortionbrownconrady ", 5, false},
                             {" rationalpolynomial  ", kMaxDistortion, false},  // and no name
                             {" equidistant fisheye kannalabrandt4 ", 4, true}};

}  // namespace

Result<Lens> lens_of(const std::string& model, std::vector<double> coefficients) {
  for (std::size_t i = 0; i < coefficients.size(); ++i) {
    if (std::isfinite(coefficients[i])) continue;
    return invalid_argument("distortion d[", i, "] is ", coefficients[i], "; it must be finite");
  }
  while (!coefficients.empty() && coefficients.back() == 0) coefficients.pop_back();
  if (coefficients.empty()) return Lens{};
  std::string plain = " ";
  for (const unsigned char c : model) {
    if (std::isalnum(c) != 0) plain.push_back(static_cast<char>(std::tolower(c)));
  }
  plain += ' ';
  for (const Model& known : kModels) {
    if (std::string(known.names).find(plain) == std::string::npos) continue;
    if (coefficients.size() <= known.coefficients) {
      return Lens{known.equidistant, std::move(coefficients)};
    }
    return invalid_argument("distortion d of the model \"", model, "\" has ", coefficients.size(),
                            " coefficients that are not 0; it must have at most ",
                            known.coefficients, ", or images must be rectified");
  }
  return Status(StatusCode::unsupported,
                concat("distortion model is \"", model,
                       "\"; it must be plumb_bob, rational_polynomial or equidistant, or images "
                       "must be rectified"));
}

Eigen::Vector2d distort(const Lens& lens, double x, double y) {
  if (!lens.equidistant) return distort(lens.coefficients, x, y);
  const double radius = std::hypot(x, y);
  if (radius == 0) return {x, y};
  const double angle = std::atan(radius);
  double bent = 0;
  for (std::size_t k = lens.coefficients.size(); k-- > 0;) {
    bent = (bent + lens.coefficients[k]) * angle * angle;
  }
  const double scale = angle * (1 + bent) / radius;
  return {scale * x, scale * y};
}

}  // namespace bpa
