// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// A program like OpenNI2's own samples and viewers, on nothing but its API: what does OpenNI2
// itself make of a device?
//   openni2_look URI [FRAMES [FILE.oni]]
// Prints name and modes, how many frames a recording holds, reads frames of depth and colour, and
// records them with OpenNI2's recorder.
#include <cstdio>
#include <cstdlib>

#include <openni2/OpenNI.h>

namespace {

int fail(const char* what) {
  std::printf("failed: %s: %s\n", what, openni::OpenNI::getExtendedError());
  return 1;
}

bool open(openni::Device& device, openni::SensorType type, const char* name,
          openni::VideoStream& stream) {
  const openni::SensorInfo* sensor = device.getSensorInfo(type);
  if (sensor == nullptr || stream.create(device, type) != openni::STATUS_OK) return false;
  const auto& modes = sensor->getSupportedVideoModes();
  for (int i = 0; i < modes.getSize(); ++i) {
    std::printf("%s mode %dx%d@%d format %d\n", name, modes[i].getResolutionX(),
                modes[i].getResolutionY(), modes[i].getFps(), modes[i].getPixelFormat());
  }
  stream.setMirroringEnabled(false);
  return true;
}

/// Reads so many frames of each stream and prints what the last ones were.
int read(openni::VideoStream& depth, openni::VideoStream& color, int frames) {
  openni::VideoStream* streams[] = {&depth, &color};
  const int count = color.isValid() ? 2 : 1;
  int seen[2] = {0, 0};
  openni::VideoFrameRef frame;
  while (seen[0] < frames || (count == 2 && seen[1] < frames)) {
    int ready = 0;
    if (openni::OpenNI::waitForAnyStream(streams, count, &ready, 3000) != openni::STATUS_OK) {
      return fail("no frame");
    }
    if (streams[ready]->readFrame(&frame) != openni::STATUS_OK) return fail("reading");
    if (++seen[ready] != frames) continue;
    const auto* z = static_cast<const openni::DepthPixel*>(frame.getData());
    if (ready == 0)
      std::printf("depth pixel 0 is %d, middle %d\n", z[0],
                  z[frame.getHeight() / 2 * frame.getWidth() + frame.getWidth() / 2]);
  }
  std::printf("read %d depth and %d color frames\n", seen[0], seen[1]);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) return 2;
  const int frames = argc > 2 ? std::atoi(argv[2]) : 0;
  if (openni::OpenNI::initialize() != openni::STATUS_OK) return fail("initialize");
  openni::Array<openni::DeviceInfo> found;
  openni::OpenNI::enumerateDevices(&found);
  for (int i = 0; i < found.getSize(); ++i) std::printf("device %s\n", found[i].getUri());
  openni::Device device;
  if (device.open(argv[1]) != openni::STATUS_OK) return fail("open");
  std::printf("name %s\n", device.getDeviceInfo().getName());
  openni::VideoStream depth, color;
  if (!open(device, openni::SENSOR_DEPTH, "depth", depth)) return fail("depth");
  open(device, openni::SENSOR_COLOR, "color", color);
  if (openni::PlaybackControl* recording = device.getPlaybackControl()) {
    std::printf("holds %d depth and %d color frames\n", recording->getNumberOfFrames(depth),
                color.isValid() ? recording->getNumberOfFrames(color) : 0);
  }
  if (device.isImageRegistrationModeSupported(openni::IMAGE_REGISTRATION_DEPTH_TO_COLOR)) {
    device.setImageRegistrationMode(openni::IMAGE_REGISTRATION_DEPTH_TO_COLOR);
    std::printf("registration %d\n", device.getImageRegistrationMode());
  }
  openni::Recorder recorder;
  if (argc > 3) {
    if (recorder.create(argv[3]) != openni::STATUS_OK) return fail("recorder");
    recorder.attach(depth);
    if (color.isValid()) recorder.attach(color);
    recorder.start();
  }
  if (depth.start() != openni::STATUS_OK) return fail("start");
  if (color.isValid() && color.start() != openni::STATUS_OK) return fail("start");
  const int result = frames > 0 ? read(depth, color, frames) : 0;
  recorder.stop();
  recorder.destroy();
  depth.stop();
  if (color.isValid()) color.stop();
  std::fflush(stdout);
  std::_Exit(result);  // Debian's DummyDevice may crash when it is closed
}
