// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <cstddef>
#include <optional>
#include <string_view>

namespace bpa {

/// How a depth camera measures.
enum class SensorKind {
  structured_light,  ///< One camera and a known pattern: Kinect v1, Xtion, PrimeSense.
  active_stereo,     ///< Two cameras and a projector: RealSense D400.
  time_of_flight,    ///< The phase of modulated light: Kinect v2, Azure Kinect.
};

/// Standard deviation of depth at distance z, metres: floor + growth * (z - from)^2. The default is
/// a Kinect's (Nguyen, Izadi and Lovell, "Modeling Kinect Sensor Noise", 3DIMPVT 2012).
struct SensorNoise {
  float floor = 0.0012f;   ///< metres
  float growth = 0.0019f;  ///< per metre
  float from = 0.4f;       ///< metres

  constexpr float operator()(float z) const { return floor + growth * (z - from) * (z - from); }
};

struct SensorType {
  std::string_view name;  ///< In settings, messages and files.
  SensorNoise noise;
};

/// Every kind, in the order of SensorKind. Active stereo has a RealSense D415's noise: z^2 * 0.08
/// pixels / (924 pixels * 55 mm) (Grunnet-Jepsen et al., "Best-known-methods for tuning Intel
/// RealSense D400 depth cameras", Intel 2018) and the rounding to millimetres. Time of flight has a
/// Kinect's: what is published of it is the noise alone (Fankhauser et al., ICAR 2015), and
/// multipath adds to that.
constexpr auto kSensorTypes = std::to_array<SensorType>({
    {"structured_light", {}},
    {"active_stereo", {0.0003f, 0.00157f, 0}},
    {"time_of_flight", {}},
});

constexpr auto kSensorKinds = [] {
  std::array<SensorKind, kSensorTypes.size()> kinds{};
  for (std::size_t i = 0; i < kinds.size(); ++i) kinds[i] = static_cast<SensorKind>(i);
  return kinds;
}();

/// The name in settings, messages and files.
constexpr std::string_view name_of(SensorKind kind) {
  return kSensorTypes[static_cast<std::size_t>(kind)].name;
}

constexpr SensorNoise noise_of(SensorKind kind) {
  return kSensorTypes[static_cast<std::size_t>(kind)].noise;
}

/// What a setting of the kind may be, for FieldRule.
inline constexpr std::string_view kSensorChoices =
    "auto structured_light active_stereo time_of_flight ";

/// Nothing for another name.
constexpr std::optional<SensorKind> sensor_kind(std::string_view name) {
  for (const SensorKind kind : kSensorKinds) {
    if (name == name_of(kind)) return kind;
  }
  return std::nullopt;
}

}  // namespace bpa
