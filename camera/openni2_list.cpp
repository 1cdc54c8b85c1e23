// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <sstream>

#include <openni2/OpenNI.h>
#include <unistd.h>

#include "camera/open_camera.hpp"
#include "camera/openni2.hpp"

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

bool permitted(const fs::path& entry, const std::string& devices) {
  char place[32];
  std::snprintf(place, sizeof place, "/%03d/%03d", std::atoi(word_of(entry / "busnum").c_str()),
                std::atoi(word_of(entry / "devnum").c_str()));
  const std::string file = devices + place;
  return access(file.c_str(), F_OK) != 0 || access(file.c_str(), R_OK | W_OK) == 0;
}

/// The modes of one sensor that we can read; what is wrong with it goes to `wrong`.
void describe_sensor(openni::Device& device, openni::SensorType type, const char* what,
                     std::ostream& out, std::ostream& wrong) {
  const openni::SensorInfo* sensor = device.getSensorInfo(type);
  if (sensor == nullptr) {
    wrong << "    ! it has no " << what << " camera\n";
    return;
  }
  const auto& modes = sensor->getSupportedVideoModes();
  std::vector<VideoMode> known;
  for (int i = 0; i < modes.getSize(); ++i) {
    if (!readable(modes[i].getPixelFormat())) continue;
    known.push_back({modes[i].getResolutionX(), modes[i].getResolutionY(), modes[i].getFps()});
  }
  out << "    " << what << ": " << list_of(known) << "\n";
  openni::VideoStream stream;
  if (stream.create(device, type) != openni::STATUS_OK) {
    wrong << "    ! its " << what << " stream cannot be made: " << openni2_error() << "\n";
    return;
  }
  const auto intrinsics = intrinsics_of(stream, "", std::string(what) + " camera");
  if (!intrinsics.ok()) wrong << "    ! " << intrinsics.status().message << "\n";
  if (known.empty()) wrong << "    ! none of its " << what << " formats can be read\n";
  stream.destroy();
}

void describe_device(const openni::DeviceInfo& info, std::ostream& out) {
  out << info.getUri() << "\n    " << info.getVendor() << " " << info.getName() << "\n";
  openni::Device device;
  if (device.open(info.getUri()) != openni::STATUS_OK) {
    out << "    ! it cannot be opened (in use by another program, or no permission): "
        << openni2_error() << "\n";
    return;
  }
  std::ostringstream wrong;
  describe_sensor(device, openni::SENSOR_DEPTH, "depth", out, wrong);
  describe_sensor(device, openni::SENSOR_COLOR, "color", out, wrong);
  const bool registers =
      device.isImageRegistrationModeSupported(openni::IMAGE_REGISTRATION_DEPTH_TO_COLOR);
  out << "    registration of depth to colour: "
      << (registers ? "the device says that it can" : "by the server") << "\n";
  device.close();
  out << (wrong.str().empty() ? "    nothing is wrong with it\n" : wrong.str());
}

/// Sensors that are plugged in; `served` is how many devices OpenNI2 has.
void describe_usb(const std::vector<UsbSensor>& sensors, int served, std::ostream& out) {
  int expected = 0;
  for (const UsbSensor& sensor : sensors) {
    const bool missing = sensor.openni2 && ++expected > served;
    if (sensor.openni2 && !missing && sensor.permitted) continue;
    out << "USB " << sensor.place << "\n    " << sensor.name << " (" << sensor.id << ")\n";
    out << "    ! it " << sensor.how << "\n";
    if (!sensor.permitted) {
      out << "    ! this user may not write to it; install the udev rules and plug it in again\n";
    }
  }
}

}  // namespace

std::vector<UsbSensor> usb_sensors(const std::string& sysfs, const std::string& devices) {
  std::vector<UsbSensor> sensors;
  std::error_code error;
  for (const fs::directory_entry& entry : fs::directory_iterator(sysfs, error)) {
    const std::string vendor = word_of(entry.path() / "idVendor");
    const std::string product = word_of(entry.path() / "idProduct");
    const Known* known = std::ranges::find_if(kKnown, [&](const Known& one) {
      return vendor == one.vendor && (one.product == nullptr || product == one.product);
    });
    if (known == std::end(kKnown)) continue;
    sensors.push_back({entry.path().filename().string(), vendor + ":" + product, known->name,
                       known->how, known->openni2, permitted(entry.path(), devices)});
  }
  std::ranges::sort(sensors, {}, &UsbSensor::place);
  return sensors;
}

Result<std::string> list_devices() {
  const auto library = load_openni2();
  if (!library.ok()) return library.status();
  openni::Array<openni::DeviceInfo> found;
  openni::OpenNI::enumerateDevices(&found);
  std::ostringstream out;
  for (int i = 0; i < found.getSize(); ++i) describe_device(found[i], out);
  describe_usb(usb_sensors("/sys/bus/usb/devices", "/dev/bus/usb"), found.getSize(), out);
  if (out.str().empty()) out << "no depth sensor is connected to this machine\n";
  return out.str();
}

}  // namespace bpa::camera
