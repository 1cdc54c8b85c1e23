// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <array>
#include <optional>
#include <string_view>

namespace bpa {

/// How a depth camera measures.
enum class SensorKind {
  structured_light,  ///< One camera and a known pattern: Kinect v1, Xtion, PrimeSense.
  active_stereo,     ///< Two cameras and a projector: RealSense D400.
  time_of_flight,    ///< The phase of modulated light: Kinect v2, Azure Kinect.
};

constexpr std::array kSensorKinds{SensorKind::structured_light, SensorKind::active_stereo,
                                  SensorKind::time_of_flight};

/// The name in settings, messages and files.
constexpr std::string_view name_of(SensorKind kind) {
  constexpr std::string_view kNames[] = {"structured_light", "active_stereo", "time_of_flight"};
  return kNames[static_cast<int>(kind)];
}

/// Nothing for another name.
constexpr std::optional<SensorKind> sensor_kind(std::string_view name) {
  for (const SensorKind kind : kSensorKinds) {
    if (name == name_of(kind)) return kind;
  }
  return std::nullopt;
}

}  // namespace bpa
