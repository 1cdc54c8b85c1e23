// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/io/camera_file.hpp"

#include <gtest/gtest.h>

#include "core/io/file_bytes.hpp"
#include "tests/support/temporary_folder.hpp"

namespace bpa::io {
namespace {

using test::spill;

TEST(CameraFile, BopJson) {
  const test::TemporaryFolder folder;
  ASSERT_TRUE(
      write_file(folder / "camera.json", camera_json({640, 480, 525.5, 526, 319.5, 239}, 0.1))
          .ok());
  const Result<CameraFile> file = read_camera(folder / "camera.json");
  ASSERT_TRUE(file.ok()) << file.status().message;
  EXPECT_EQ(file->camera.width, 640);
  EXPECT_EQ(file->camera.fx, 525.5);
  EXPECT_EQ(file->camera.cy, 239);
  EXPECT_EQ(file->depth_scale_mm, 0.1);
}

/// A camera as one of the forms in use. All but `bare` ones say the size.
struct Form {
  const char* name;
  std::string text;
  bool sized = true;
};

class Forms : public testing::TestWithParam<Form> {};

TEST_P(Forms, AreTheSameCameraToTheBit) {
  const test::TemporaryFolder folder;
  spill(folder / "camera", GetParam().text);
  const Result<CameraFile> file = read_camera(folder / "camera");
  ASSERT_TRUE(file.ok()) << file.status().message;
  EXPECT_EQ(file->camera.fx, 1066.778);
  EXPECT_EQ(file->camera.fy, 1067.487);
  EXPECT_EQ(file->camera.cx, 312.9869);
  EXPECT_EQ(file->camera.cy, 241.3109);
  EXPECT_EQ(file->camera.width, GetParam().sized ? 640 : 0);
  EXPECT_EQ(file->camera.height, GetParam().sized ? 480 : 0);
  EXPECT_TRUE(notes_of(*file, "is taken out").empty()) << notes_of(*file, "is taken out").front();
}

const std::string kRows = "[1066.778, 0, 312.9869, 0, 1067.487, 241.3109, 0, 0, 1]";
const std::string kColumns = "[1066.778, 0, 0, 0, 1067.487, 0, 312.9869, 241.3109, 1]";
const std::string kNested = "[[1066.778, 0, 312.9869],\n [0, 1067.487, 241.3109],\n [0, 0, 1]]";
const std::string kInfo =
    "header:\n  stamp: {sec: 1, nanosec: 2}\n  frame_id: cam\nheight: 480\nwidth: 640\n"
    "distortion_model: plumb_bob\n";
const std::string kScene = R"({"cam_K": )" + kRows + R"(, "depth_scale": 0.1})";

const Form kForms[] = {
    {"Bop", R"({"fx": 1066.778, "fy": 1067.487, "cx": 312.9869, "cy": 241.3109, "width": 640,
                "height": 480, "depth_scale": 0.1})"},
    {"BopScene", R"({"0": )" + kScene + R"(, "12": )" + kScene + "}", false},
    {"Nested", R"({"K": )" + kNested + R"(, "width": 640, "height": 480})"},
    {"Open3d", R"({"width": 640, "height": 480, "intrinsic_matrix": )" + kColumns + "}"},
    {"Open3dRowByRow", R"({"width": 640, "height": 480, "intrinsic_matrix": )" + kRows + "}"},
    {"Open3dParameters", R"({"class_name": "PinholeCameraParameters", "extrinsic": [1, 0],
        "intrinsic": {"width": 640, "height": 480, "intrinsic_matrix": )" +
                             kColumns + R"(}, "version_major": 1, "version_minor": 0})"},
    {"Realsense", R"({"width": 640, "height": 480, "ppx": 312.9869, "ppy": 241.3109,
        "fx": 1066.778, "fy": 1067.487, "model": "Brown Conrady", "coeffs": [0, 0, 0, 0, 0]})"},
    {"Calibrator",
     "image_width: 640\nimage_height: 480\ncamera_name: x\ncamera_matrix:\n  rows: 3\n  cols: 3\n"
     "  data: " +
         kRows +
         "\ndistortion_model: plumb_bob\ndistortion_coefficients:\n  rows: 1\n  cols: 5\n"
         "  data: [0, 0, 0, 0, 0]\nrectification_matrix:\n  rows: 3\n  cols: 3\n  data: [1]\n"},
    {"TopicEcho", kInfo + "d:\n- 0.0\n- 0.0\nk:\n- 1066.778\n- 0.0\n- 312.9869\n- 0.0\n- 1067.487\n"
                          "- 241.3109\n- 0.0\n- 0.0\n- 1.0\nbinning_x: 0\nroi:\n  x_offset: 0\n"
                          "  width: 0\n  do_rectify: false\n---\n"},
    {"Ros1Echo", kInfo + "D: [0.0, 0.0, 0.0, 0.0, 0.0]\nK: " + kRows + "\nR: [1]\nP: [2]\n---\n"},
    {"OpenCv",
     "%YAML:1.0\n---\nimage_width: 640\nimage_height: 480\n"
     "camera_matrix: !!opencv-matrix\n   rows: 3\n   cols: 3\n   dt: d\n   data: " +
         kRows + "\n"},
    {"Kalibr",
     "cam0:\n  camera_model: pinhole\n  resolution: [640, 480]\n"
     "  intrinsics: [1066.778, 1067.487, 312.9869, 241.3109]\n"},
    {"MatrixInText", "1066.778 0 312.9869\r\n0 1067.487 241.3109\r\n0 0 1.0\r\n", false},
    {"ListInText", kNested, false},
    {"ScanNet", "1066.778 0 312.9869 0\n0 1067.487 241.3109 0\n0 0 1 0\n0 0 0 1\n", false},
    {"Nerf", R"({"fl_x": 1066.778, "fl_y": 1067.487, "cx": 312.9869, "cy": 241.3109, "w": 640,
                 "h": 480, "k1": 0, "k2": 0, "p1": 0, "p2": 0, "camera_model": "OPENCV"})"},
    {"FocalLength", R"({"focal_length": [1066.778, 1067.487], "width": 640, "height": 480,
                        "principal_point": [312.9869, 241.3109]})"},
    {"OrbSlam",
     "%YAML:1.0\n---\nCamera.type: \"PinHole\"\nCamera.fx: 1066.778\nCamera.fy: 1067.487\n"
     "Camera.cx: 312.9869\nCamera.cy: 241.3109\nCamera.k1: 0.0\nCamera.k2: 0.0\nCamera.p1: 0.0\n"
     "Camera.p2: 0.0\nCamera.width: 640\nCamera.height: 480\nDepthMapFactor: 5000.0\n"},
    {"Quoted", R"({"fx": "1066.778", "fy": "1067.487", "cx": "312.9869", "cy": "241.3109",
                   "width": "640", "height": "480"})"},
    {"ListOfOne", R"([{"K": )" + kNested + R"(, "width": 640, "height": 480}])"},
    {"Open3dTrajectory", R"({"class_name": "PinholeCameraTrajectory", "parameters": [
        {"class_name": "PinholeCameraParameters", "extrinsic": [1, 0],
         "intrinsic": {"width": 640, "height": 480, "intrinsic_matrix": )" +
                             kColumns + R"(}, "version_major": 1, "version_minor": 0}]})"},
    {"CalibratorIni",
     "# oST version 5.0 parameters\n\n[image]\n\nwidth\n640\n\nheight\n480\n\n[narrow_stereo]\n\n"
     "camera matrix\n1066.778 0.000000 312.9869\n0.000000 1067.487 241.3109\n"
     "0.000000 0.000000 1.000000\n\ndistortion\n0.0 0.0 0.0 0.0 0.0\n\nrectification\n1 0 0\n0 1 "
     "0\n"
     "0 0 1\n\nprojection\n900 0 310 0\n0 900 240 0\n0 0 1 0\n"},
    {"KeysOfIni",
     "; a Kinect\r\nwidth = 640\r\nheight = 480\r\n[RGB]\r\nfx=1066.778\r\nfy=1067.487\r\n"
     "cx = 312.9869\r\ncy = \"241.3109\"\r\nk1=0.0\r\n"},
    {"OpenCvXml",
     "<?xml version=\"1.0\"?>\n<opencv_storage>\n<image_width>640</image_width>\n"
     "<image_height>480</image_height>\n<camera_matrix type_id=\"opencv-matrix\">\n"
     "  <rows>3</rows>\n  <cols>3</cols>\n  <dt>d</dt>\n  <data>\n"
     "    1066.778 0. 312.9869 0. 1067.487\n    241.3109 0. 0. 1.</data></camera_matrix>\n"
     "</opencv_storage>\n"},
    {"Tum", "# fx fy cx cy\n1066.778 1067.487 312.9869 241.3109\n", false},
};

INSTANTIATE_TEST_SUITE_P(All, Forms, testing::ValuesIn(kForms),
                         [](const auto& test) { return test.param.name; });

TEST(CameraFile, ReadsTheUnitOfDepth) {
  const test::TemporaryFolder folder;
  spill(folder / "c", R"({"0": )" + kScene + "}");
  EXPECT_EQ(read_camera(folder / "c")->depth_scale_mm, 0.1);
  spill(folder / "c", R"({"depth_scale": 0.25, "color": {"K": )" + kRows + "}}");
  EXPECT_EQ(read_camera(folder / "c")->depth_scale_mm, 0.25);
}

/// Coefficients under keys of their own; units of one metre.
TEST(CameraFile, ReadsTheLensOfSlamAndNerf) {
  const test::TemporaryFolder folder;
  const std::string slam =
      "Camera1.fx: 600\nCamera1.fy: 600\nCamera1.cx: 320\nCamera1.cy: 240\nCamera1.k1: 0.1\n"
      "Camera1.k2: 0.2\nCamera1.k3: 0.3\nRGBD.DepthMapFactor: 5000.0\n";
  spill(folder / "c", slam + "Camera1.p1: 0.4\nCamera1.p2: 0.5\n");
  const auto file = read_camera(folder / "c");
  ASSERT_TRUE(file.ok()) << file.status().message;
  EXPECT_EQ(file->distortion, (std::vector<double>{0.1, 0.2, 0.4, 0.5, 0.3}));
  EXPECT_EQ(file->depth_scale_mm, 0.2);
  spill(folder / "c", slam + "Camera1.k4: 0.4\nCamera1.camera_model: OPENCV_FISHEYE\n");
  const auto fisheye = read_camera(folder / "c");
  EXPECT_EQ(fisheye->distortion, (std::vector<double>{0.1, 0.2, 0.3, 0.4}));
  EXPECT_EQ(fisheye->distortion_model, "equidistant");
  spill(folder / "c", slam + "Camera2.fx: 601\nCamera2.fy: 600\nCamera2.cx: 320\nCamera2.cy: 1\n");
  EXPECT_NE(read_camera(folder / "c").status().message.find("differ (Camera1, Camera2)"),
            std::string::npos);
}

TEST(CameraFile, SaysWhatIsNotReadAndThatDistortionIsIgnored) {
  const test::TemporaryFolder folder;
  spill(folder / "c", R"({"K": )" + kRows + R"(, "factor_depth": 10000, "units": {"m": 1}})");
  EXPECT_EQ(notes_of(*read_camera(folder / "c"), "is taken out"),
            std::vector<std::string>{"does not read: factor_depth, units"});
  spill(folder / "c", "1066.778 1067.487 312.9869 241.3109 0.2 -0.1 0 0 0.3\n");
  const Result<CameraFile> file = read_camera(folder / "c");
  ASSERT_TRUE(file.ok()) << file.status().message;
  EXPECT_EQ(file->distortion, (std::vector<double>{0.2, -0.1, 0, 0, 0.3}));
  EXPECT_EQ(notes_of(*file, "is taken out").size(), 1U);
}

/// As calibrators write it: the images as they are have K and D, rectified ones P.
TEST(CameraFile, ReadsTheCameraOfRectifiedImages) {
  const test::TemporaryFolder folder;
  const std::string p = "P: [900, 0, 310, 0, 0, 901, 240, 0, 0, 0, 1, 0]\n";
  spill(folder / "c", kInfo + "K: " + kRows + "\nD: [0.1, 0, 0, 0, 0]\n" + p);
  const auto file = read_camera(folder / "c");
  ASSERT_TRUE(file.ok()) << file.status().message;
  EXPECT_EQ(file->camera.fx, 1066.778);
  ASSERT_TRUE(file->rectified);
  EXPECT_EQ(file->rectified->fx, 900);
  EXPECT_EQ(file->rectified->fy, 901);
  EXPECT_EQ(file->rectified->cx, 310);
  EXPECT_EQ(file->rectified->cy, 240);
  EXPECT_EQ(file->rectified->width, 640);
  spill(folder / "c", kInfo + p);
  EXPECT_EQ(read_camera(folder / "c")->camera.fx, 900);
  spill(folder / "c", kInfo + "binning_x: 2\nbinning_y: 2\nK: " + kRows + "\n");
  EXPECT_NE(read_camera(folder / "c").status().message.find("binning of 2"), std::string::npos);
  spill(folder / "c",
        kInfo + "roi: {x_offset: 4, y_offset: 0, width: 320, height: 240}\nK: " + kRows + "\n");
  EXPECT_NE(read_camera(folder / "c").status().message.find("must be empty or the whole image"),
            std::string::npos);
  spill(folder / "c", "header: {stamp: 1}\nname: cam\n");
  EXPECT_NE(read_camera(folder / "c").status().message.find("it has: header, name"),
            std::string::npos);
}

/// What is refused, with the field, the rule, and the form that would be read.
TEST(CameraFile, RefusalsShowTheAcceptedFormWithTheNumbersFound) {
  const test::TemporaryFolder folder;
  const std::string four = R"("fx": 1066.778, "fy": 1067.487, "cx": 312.9869, "cy": 241.3109)";
  const struct {
    std::string text, said, form;
  } cases[] = {
      {R"({"fx": 0, "fy": 500, "cx": 1, "cy": 1})", "fx is 0; it must be positive",
       R"({"fx": 0, "fy": 500,)"},
      {R"({"fx": 500, "cx": 1, "cy": 1})", "'fy'", R"({"fx": 500, "fy": ..., "cx": 1)"},
      {R"({"fx": 500, )", "not JSON", R"({"fx": ..., "fy": ...)"},
      {"image_width: [1", "", R"({"fx": ...)"},
      {R"({"focal": 500, "centre": [1, 2]})", "it has: centre, focal", R"({"fx": ...)"},
      {R"({"cam_K": )" + kColumns + R"(, "depth_scale": 0.1})",
       "third row of its matrix is 312.987 241.311 1; it must be 0 0 1",
       "{" + four + R"(, "width": ..., "height": ..., "depth_scale": 0.1})"},
      {R"({"K": [1066.778, 90, 312.9869, 0, 1067.487, 241.3109, 0, 0, 1]})", "skew 90", "{" + four},
      {R"({"K": [1, 2, 3]})", "3 numbers", "..."},
      {"1 2 3", "3 numbers", "..."},
      {R"({"fx": 1, "fy": 1, "cx": 1, "cy": 1, "depth_scale": 0.001})", "not metres of one unit",
       R"("depth_scale": 1.0})"},
      {R"({"fx": 1, "fy": 1, "cx": 1, "cy": 1, "depth_scale": 5000})", "not units of one metre",
       R"("depth_scale": 0.2})"},
      {R"({"fx": 500, "fy": 500, "cx": 1, "cy": 1, "width": 640})", "height is 0",
       R"("width": 640, "height": ...)"},
      {R"({"color": {"fx": 1, "fy": 1, "cx": 1, "cy": 1}, "depth":
           {"fx": 2, "fy": 1, "cx": 1, "cy": 1}})",
       "2 cameras that differ (color, depth)", R"({"fx": 1,)"}};
  for (const auto& one : cases) {
    spill(folder / "c", one.text);
    const Status status = read_camera(folder / "c").status();
    EXPECT_TRUE(status.code == StatusCode::invalid_argument || status.code == StatusCode::corrupt);
    EXPECT_NE(status.message.find(one.said), std::string::npos) << status.message;
    EXPECT_NE(status.message.find("Accepted is"), std::string::npos) << status.message;
    EXPECT_NE(status.message.find(one.form), std::string::npos) << status.message;
  }
  EXPECT_EQ(read_camera(folder / "none").status().code, StatusCode::not_found);
}

}  // namespace
}  // namespace bpa::io
