// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/doctor/frame_check.hpp"

#include <algorithm>
#include <cmath>

#include "core/base/concat.hpp"
#include "core/base/median.hpp"
#include "core/cloud/depth_unit.hpp"
#include "core/doctor/result_check.hpp"
#include "core/geometry/camera.hpp"

namespace bpa::doctor {
namespace {

// Chosen by hand; in brackets what good frames have at most (8 of YCB-Video, 7 of the Object
// Segmentation Database, 1 of PCL, simulated ones).
constexpr double kMinFov_deg = 30, kMaxFov_deg = 120;  // [33 to 63]
constexpr double kMaxOffCentre = 0.15;                 // of the image's size [0.011]
constexpr double kMaxAspect = 1.05;                    // fx over fy or the reverse [1.001]
constexpr double kMaxHoles = 0.6;                      // share of the pixels [0.46]
constexpr double kMaxFar = 0.6;                        // share of the depths beyond the range [0.2]
constexpr double kNear_m = 0.2;                        // median; below what sensors measure [0.61]
constexpr double kFarthest_m = 20;                     // median; validate(Frame) allows no more
constexpr double kMetresGiven_m = 0.02;                // median of depth 1000 times too small
constexpr int kDark = 25, kBright = 235;               // median luminance of 255 [70 to 196]
constexpr double kMaxClipped = 0.5;                    // share of the pixels [0.33]

// Of the registration. What the best offset gains over chance, the share of that gain which the
// frame has as it is, and the displacement in pixels of an image 640 wide.
constexpr double kMinGain = 0.2;    // clear best offsets [0.25 to 0.52]
constexpr double kMaxShare = 0.45;  // [0.55]; 0.0 to 0.4 when 12 pixels off
constexpr double kMinPixels = 6;    // [3, where the share is above 0.9]

std::string percent(double share) { return fixed(100 * share, 0) + " %"; }

void check_camera(const Camera& camera, Findings& findings) {
  const char* const remedy =
      "Give the intrinsics of the colour camera at this image size; scale fx, fy, cx and cy with "
      "the image when it is resized, and move cx and cy when it is cropped.";
  const double fov = 2 * std::atan(0.5 * camera.width / camera.fx) * 180 / M_PI;
  if (fov < kMinFov_deg || fov > kMaxFov_deg) {
    findings.push_back({Severity::warning, "the focal length does not fit the image",
                        concat("fx ", fixed(camera.fx, 1), " at a width of ", camera.width,
                               " is a field of view of ", fixed(fov, 0),
                               " degrees; depth cameras have ", kMinFov_deg, " to ", kMaxFov_deg),
                        remedy});
  }
  const double aspect = camera.fx / camera.fy;
  if (std::max(aspect, 1 / aspect) > kMaxAspect) {
    findings.push_back({Severity::warning, "the focal lengths differ",
                        concat("fx is ", fixed(camera.fx, 1), " and fy ", fixed(camera.fy, 1),
                               "; sensors have square pixels"),
                        remedy});
  }
  const double off_u = std::abs(camera.cx / (camera.width - 1) - 0.5);
  const double off_v = std::abs(camera.cy / (camera.height - 1) - 0.5);
  if (std::max(off_u, off_v) > kMaxOffCentre) {
    findings.push_back({Severity::warning, "the principal point is far from the centre",
                        concat("(cx, cy) is (", fixed(camera.cx, 1), ", ", fixed(camera.cy, 1),
                               "), the centre of the image (", 0.5 * (camera.width - 1), ", ",
                               0.5 * (camera.height - 1), ")"),
                        remedy});
  }
}

/// Whether depths are of 16 bits whose bytes are swapped: neighbours, which differ by little,
/// differ by 256 times as much.
bool bytes_swapped(const Frame& frame) {
  constexpr double kUnits_mm[] = {1, 0.5, 0.25, 0.2, 0.125, 0.1};
  constexpr std::size_t kEnough = 500;
  constexpr float kMuch = 10;  // of 256, where depth is noisy [0.1]
  const auto units = [](float z, double unit_mm) {
    return 1000 * static_cast<double>(z) / unit_mm;
  };
  const auto* const unit_mm = std::ranges::find_if(kUnits_mm, [&](double mm) {
    return std::ranges::all_of(frame.depth, [&](float z) {
      const double u = units(z, mm);
      return !(z > 0) || (u < 65535.5 && std::abs(u - std::round(u)) < 0.02);
    });
  });
  if (unit_mm == std::end(kUnits_mm)) return false;
  const auto whole = [&](float z) { return static_cast<int>(std::lround(units(z, *unit_mm))); };
  const auto swap = [](int u) { return (u >> 8) | ((u & 255) << 8); };
  std::vector<float> now, swapped;
  for (std::size_t i = 1; i < frame.depth.size(); ++i) {
    const float before = frame.depth[i - 1], here = frame.depth[i];
    if (!(before > 0) || !(here > 0) || before == here) continue;
    const int a = whole(before), b = whole(here);
    now.push_back(static_cast<float>(std::abs(a - b)));
    swapped.push_back(static_cast<float>(std::abs(swap(a) - swap(b))));
  }
  return now.size() > kEnough && median(now) > kMuch * median(swapped);
}

/// Whether the unit of depth is right; nothing else of depth can be judged otherwise.
bool check_unit(double median_m, Findings& findings) {
  const char* const remedy =
      "Correct the scale: of clouds --unit; of depth images of whole numbers, depth_scale of "
      "camera.json or scene_camera.json, millimetres for one unit; 16UC1 topics are millimetres, "
      "32FC1 topics metres.";
  if (median_m > kFarthest_m) {
    findings.push_back({Severity::error, "depth is in the wrong unit",
                        concat("its median is ", fixed(median_m, 0), " m: ",
                               median_m > kMillimetresFrom ? "millimetres" : "smaller units",
                               " are taken for metres"),
                        remedy});
    return false;
  }
  if (median_m < kMetresGiven_m) {
    findings.push_back({Severity::error, "depth is in the wrong unit",
                        concat("its median is ", fixed(1e3 * median_m, 2),
                               " mm: metres are taken for millimetres"),
                        remedy});
    return false;
  }
  return true;
}

void check_distance(const std::vector<float>& depths, double median_m, double max_range_m,
                    Findings& findings) {
  const auto beyond = std::ranges::count_if(depths, [&](float z) { return z > max_range_m; });
  const double far = static_cast<double>(beyond) / static_cast<double>(depths.size());
  if (far > kMaxFar) {
    findings.push_back(
        {Severity::warning, "the scene is too far away",
         concat(percent(far), " of the depths are beyond ", max_range_m,
                " m, where nothing is searched; the median is ", fixed(median_m, 2), " m"),
         "Move the camera nearer or raise surface.max_range_m. If the scene is "
         "nearer, correct the depth scale."});
  }
  if (median_m < kNear_m) {
    findings.push_back({Severity::warning, "the scene is too near",
                        concat("the median depth is ", fixed(1000 * median_m, 0),
                               " mm; Kinect-class sensors measure from 400 mm on"),
                        "Move the camera away. If the scene is farther, correct the depth scale."});
  }
}

void check_exposure(const std::vector<std::uint8_t>& color, Findings& findings) {
  constexpr int kFull = 254;  // of 255
  std::vector<float> luminance;
  std::size_t clipped = 0;
  for (std::size_t i = 0; i + 2 < color.size(); i += 3) {
    const int r = color[i], g = color[i + 1], b = color[i + 2];
    luminance.push_back(0.2126f * static_cast<float>(r) + 0.7152f * static_cast<float>(g) +
                        0.0722f * static_cast<float>(b));  // Rec. 709
    clipped += std::max({r, g, b}) >= kFull;
  }
  const double share = static_cast<double>(clipped) / static_cast<double>(luminance.size());
  const float middle = median(luminance);
  const std::string why = concat("its median luminance is ", fixed(static_cast<double>(middle), 0),
                                 " of 255, and ", percent(share), " of the pixels are clipped");
  if (middle < kDark) {
    findings.push_back({Severity::warning, "colour is too dark", why,
                        "Add light, or raise exposure or gain (capture.auto_exposure)."});
  } else if (middle > kBright || share > kMaxClipped) {
    findings.push_back({Severity::warning, "colour is too bright", why,
                        "Take light away, or lower exposure or gain (capture.auto_exposure)."});
  }
}

void check_registration(const Frame& frame, int num_threads, Findings& findings) {
  const auto offset = find_edge_offset(frame, num_threads);
  if (!offset) return;
  const double gain = offset->agreement - offset->agreement_chance;
  const double gain_now = offset->agreement_now - offset->agreement_chance;
  if (gain < kMinGain || gain_now > kMaxShare * gain) return;
  if (offset->pixels < kMinPixels * frame.camera.width / 640.0) return;
  findings.push_back(
      {Severity::error, "depth is not registered to colour",
       concat("depth edges are ", fixed(offset->pixels, 0),
              " pixels from colour edges on average; they fit when moved ", fixed(offset->right, 0),
              " right and ", fixed(offset->down, 0), " down",
              offset->scale == 1 ? "" : " and scaled by " + fixed(offset->scale, 2)),
       "Have the driver register depth to colour (align_depth, depth_registration, "
       "capture.registration), and take both images at the same moment and size."});
}

}  // namespace

Findings check_frame(const Frame& frame, double max_range_m, int num_threads) {
  Findings findings;
  Frame clean = frame;
  clean_depth(clean);
  if (const Status status = validate(frame.camera); !status.ok()) {
    return {{Severity::error, "the camera cannot be used", status.message,
             "Correct the camera file or the camera_info topic."}};
  }
  check_camera(frame.camera, findings);
  std::vector<float> depths;
  for (const float z : frame.depth) {
    if (z > 0 && std::isfinite(z)) depths.push_back(z);
  }
  const double median_m = depths.empty() ? 0 : static_cast<double>(median(depths));
  if (bytes_swapped(frame)) {
    findings.push_back({Severity::error, "depth has the bytes of its numbers swapped",
                        "neighbours differ 256 times as much as in the other byte order",
                        "Write 16-bit PNG and PGM with the higher byte first (OpenCV and Pillow do "
                        "so from arrays of uint16), and set is_bigendian of topics as it is."});
    return findings;
  }
  if (!depths.empty() && !check_unit(median_m, findings)) return findings;
  if (const Status status = validate(clean); !status.ok()) {
    findings.push_back({Severity::error, "the frame cannot be searched", status.message,
                        "Check that the sensor's projector is on and sees the scene."});
    return findings;
  }
  const double holes =
      1 - static_cast<double>(depths.size()) / static_cast<double>(frame.depth.size());
  if (holes > kMaxHoles) {
    findings.push_back({Severity::warning, "depth has large holes",
                        percent(holes) + " of the pixels have no depth",
                        "Keep sunlight and shiny or transparent surfaces out of the view, and the "
                        "scene between 0.4 and 3 m. A second sensor's projector disturbs too."});
  }
  check_distance(depths, median_m, max_range_m, findings);
  if (clean.color.empty()) return findings;
  const std::size_t before = findings.size();
  check_exposure(clean.color, findings);
  // The dark and the bright have no hues either.
  if (findings.size() == before && color_content(clean) != ColorContent::hues) {
    findings.push_back(
        {Severity::warning, "colour has no hues",
         "the image is grey, or of one colour: models are compared by shape and outline alone",
         "Give images in colour; without them, objects of one shape are confused."});
  }
  check_registration(clean, num_threads, findings);
  return findings;
}

Status make_searchable(Frame& frame, double max_range_m, int num_threads) {
  std::vector<float> raw = frame.depth;
  clean_depth(frame);
  Status status = validate(frame);
  if (status.ok()) return status;
  frame.depth = std::move(raw);
  const std::string lines = lines_of(check_frame(frame, max_range_m, num_threads));
  if (!lines.empty()) status.message = lines.substr(0, lines.find('\n'));
  return status;
}

}  // namespace bpa::doctor
