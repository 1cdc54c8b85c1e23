// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "camera/usb_sensors.hpp"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>

#include <unistd.h>

namespace bpa::camera {
namespace {

namespace fs = std::filesystem;

struct Known {
  const char* vendor;
  const char* product;  ///< nullptr: any.
  const char* name;
  bool openni2;
  const char* how;
};

constexpr const char* kFreenect =
    "needs the freenect driver for OpenNI2 (libFreenectDriver.so of libfreenect) in "
    "OpenNI2/Drivers";
constexpr const char* kStock = "works with OpenNI2's own driver";
constexpr const char* kRos = "has no OpenNI2 driver; run its ROS 2 node and use the camera topics";

constexpr Known kKnown[] = {
    {"045e", "02ae", "Kinect v1", true, kFreenect},
    {"045e", "02bf", "Kinect for Windows v1", true, kFreenect},
    {"045e", "02c4", "Kinect v2", false, kRos},
    {"045e", "02d8", "Kinect v2", false, kRos},
    {"045e", "097c", "Azure Kinect", false, kRos},
    {"1d27", nullptr, "PrimeSense or Xtion sensor", true, kStock},
    {"2bc5", nullptr, "Orbbec sensor", true,
     "needs Orbbec's driver for OpenNI2, or its ROS 2 node"},
    {"8086", "0ad3", "RealSense D415", false, kRos},
    {"8086", "0b07", "RealSense D435", false, kRos},
    {"8086", "0b3a", "RealSense D435i", false, kRos},
    {"8086", "0b5c", "RealSense D455", false, kRos},
};

std::string word_of(const fs::path& path) {
  std::ifstream file(path);
  std::string word;
  file >> word;
  return word;
}

const Known* find(const std::string& vendor, const std::string& product) {
  for (const Known& known : kKnown) {
    if (vendor == known.vendor && (known.product == nullptr || product == known.product)) {
      return &known;
    }
  }
  return nullptr;
}

bool permitted(const fs::path& entry, const std::string& devices) {
  char place[32];
  std::snprintf(place, sizeof place, "/%03d/%03d", std::atoi(word_of(entry / "busnum").c_str()),
                std::atoi(word_of(entry / "devnum").c_str()));
  const std::string file = devices + place;
  return access(file.c_str(), F_OK) != 0 || access(file.c_str(), R_OK | W_OK) == 0;
}

}  // namespace

std::vector<UsbSensor> usb_sensors(const std::string& sysfs, const std::string& devices) {
  std::vector<UsbSensor> sensors;
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(sysfs, error)) {
    const std::string vendor = word_of(entry.path() / "idVendor");
    const std::string product = word_of(entry.path() / "idProduct");
    const Known* known = find(vendor, product);
    if (known == nullptr) continue;
    sensors.push_back({entry.path().filename().string(), vendor + ":" + product, known->name,
                       known->how, known->openni2, permitted(entry.path(), devices)});
  }
  std::sort(sensors.begin(), sensors.end(),
            [](const UsbSensor& a, const UsbSensor& b) { return a.place < b.place; });
  return sensors;
}

}  // namespace bpa::camera
