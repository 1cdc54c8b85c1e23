// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include <sstream>

#include <openni2/OpenNI.h>

#include "camera/openni2_device.hpp"
#include "camera/openni2_library.hpp"
#include "camera/openni2_streams.hpp"
#include "camera/usb_sensors.hpp"
#include "camera/video_mode.hpp"

namespace bpa::camera {
namespace {

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

Result<std::string> list_devices() {
  auto library = Openni2Library::load();
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
