// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/io/image_file.hpp"

#include <cmath>

#include <gtest/gtest.h>
#include <opencv2/imgcodecs.hpp>
#include <opencv2/imgproc.hpp>
#include <turbojpeg.h>

#include "tests/support/temporary_folder.hpp"

namespace bpa::io {
namespace {

using test::slurp;
using test::spill;

ColorImage gradient(int width, int height) {
  ColorImage image{width, height, {}};
  for (int i = 0; i < width * height; ++i) {
    image.pixels.push_back(static_cast<std::uint8_t>(i));
    image.pixels.push_back(static_cast<std::uint8_t>(3 * i + 1));
    image.pixels.push_back(static_cast<std::uint8_t>(255 - i));
  }
  return image;
}

GrayImage ramp(int width, int height) {
  GrayImage image{width, height, {}};
  for (int i = 0; i < width * height; ++i) {
    image.pixels.push_back(static_cast<std::uint16_t>(61 * i));
  }
  return image;
}

TEST(ImageFile, ColorSurvivesWritingAndReading) {
  const test::TemporaryFolder folder;
  const ColorImage image = gradient(31, 17);
  ASSERT_TRUE(write_color_png(folder / "deep/er/a.png", image).ok());
  const Result<ColorImage> back = read_color_image(folder / "deep/er/a.png");
  ASSERT_TRUE(back.ok()) << back.status().message;
  EXPECT_EQ(back->width, 31);
  EXPECT_EQ(back->height, 17);
  EXPECT_EQ(back->pixels, image.pixels);
}

TEST(ImageFile, DepthKeepsAll16Bits) {
  const test::TemporaryFolder folder;
  const GrayImage image = ramp(40, 30);
  ASSERT_TRUE(write_gray_png(folder / "d.png", image).ok());
  const Result<GrayImage> back = read_gray_png(folder / "d.png");
  ASSERT_TRUE(back.ok()) << back.status().message;
  EXPECT_EQ(back->pixels, image.pixels);
  const Result<ImageSize> size = read_png_size(folder / "d.png");
  ASSERT_TRUE(size.ok());
  EXPECT_EQ(size->width, 40);
  EXPECT_EQ(size->height, 30);
  EXPECT_EQ(size->bit_depth, 16);
  EXPECT_EQ(size->channels, 1);
}

std::string encoded_by_opencv(const char* extension, const cv::Mat& image) {
  std::vector<std::uint8_t> bytes;
  EXPECT_TRUE(cv::imencode(extension, image, bytes));
  return {bytes.begin(), bytes.end()};
}

cv::Mat decoded_by_opencv(const std::string& bytes, int flags) {
  return cv::imdecode(std::vector<std::uint8_t>(bytes.begin(), bytes.end()), flags);
}

cv::Mat random_image(int type) {
  cv::Mat image(37, 53, type);
  cv::RNG random(7);
  random.fill(image, cv::RNG::UNIFORM, 0, CV_MAT_DEPTH(type) == CV_16U ? 65536 : 256);
  cv::blur(image, image, {3, 3});
  return image;
}

// The largest difference of a value from those of bgr.
int largest_difference(const ColorImage& image, const cv::Mat& bgr) {
  cv::Mat rgb;
  cv::cvtColor(bgr, rgb, cv::COLOR_BGR2RGB);
  const cv::Mat own(image.height, image.width, CV_8UC3,
                    const_cast<std::uint8_t*>(image.pixels.data()));
  return static_cast<int>(cv::norm(own, rgb, cv::NORM_INF));
}

TEST(ImageFile, ColorsAreDecodedAsByOpenCv) {
  for (const char* extension : {".png", ".jpg"}) {
    for (const int type : {CV_8UC1, CV_8UC3, CV_8UC4, CV_16UC3}) {
      if (extension[1] == 'j' && type != CV_8UC1 && type != CV_8UC3) continue;
      const std::string bytes = encoded_by_opencv(extension, random_image(type));
      const Result<ColorImage> image = decode_color_image(bytes, "it", 10000);
      ASSERT_TRUE(image.ok()) << extension << type << image.status().message;
      const cv::Mat other = decoded_by_opencv(bytes, cv::IMREAD_COLOR);
      // From 16 bits to 8, OpenCV takes the upper byte, and libpng rounds.
      EXPECT_LE(largest_difference(*image, other), type == CV_16UC3 ? 1 : 0) << extension << type;
    }
  }
}

TEST(ImageFile, DepthIsDecodedAsByOpenCv) {
  const cv::Mat depth = random_image(CV_16UC1);
  const Result<GrayImage> image = decode_depth_png(encoded_by_opencv(".png", depth), "it");
  ASSERT_TRUE(image.ok()) << image.status().message;
  EXPECT_EQ(image->pixels,
            std::vector<std::uint16_t>(depth.begin<std::uint16_t>(), depth.end<std::uint16_t>()));
  const Result<std::string> bytes = encode_gray_png(*image);
  ASSERT_TRUE(bytes.ok());
  EXPECT_EQ(cv::norm(decoded_by_opencv(*bytes, cv::IMREAD_UNCHANGED), depth, cv::NORM_INF), 0);
}

TEST(ImageFile, JpegsAreDecodedByOpenCv) {
  const ColorImage image = gradient(64, 48);
  const Result<std::string> bytes = encode_jpeg(image, 95);
  ASSERT_TRUE(bytes.ok());
  const Result<ColorImage> back = decode_color_image(*bytes, "it", 10000);
  ASSERT_TRUE(back.ok()) << back.status().message;
  EXPECT_EQ(largest_difference(*back, decoded_by_opencv(*bytes, cv::IMREAD_COLOR)), 0);
}

TEST(ImageFile, InksAreDecodedAsByOpenCv) {
  const cv::Mat cmyk = random_image(CV_8UC4);
  const std::unique_ptr<void, decltype(&tjDestroy)> jpeg(tjInitCompress(), tjDestroy);
  unsigned char* data = nullptr;
  unsigned long size = 0;
  ASSERT_EQ(tjCompress2(jpeg.get(), cmyk.data, cmyk.cols, 0, cmyk.rows, TJPF_CMYK, &data, &size,
                        TJSAMP_444, 95, 0),
            0);
  const std::string bytes(data, data + size);
  tjFree(data);
  const Result<ColorImage> image = decode_color_image(bytes, "it", 10000);
  ASSERT_TRUE(image.ok()) << image.status().message;
  // OpenCV divides by 256.
  EXPECT_LE(largest_difference(*image, decoded_by_opencv(bytes, cv::IMREAD_COLOR)), 2);
}

TEST(ImageFile, EveryTruncationIsCorruptAndNamesTheFile) {
  const test::TemporaryFolder folder;
  ASSERT_TRUE(write_color_png(folder / "a.png", gradient(20, 20)).ok());
  const std::string bytes = slurp(folder / "a.png");
  for (std::size_t size = 0; size < bytes.size(); size += 7) {
    spill(folder / "cut.png", bytes.substr(0, size));
    const Result<ColorImage> image = read_color_image(folder / "cut.png");
    ASSERT_FALSE(image.ok());
    EXPECT_EQ(image.status().code, StatusCode::corrupt);
    EXPECT_NE(image.status().message.find("cut.png"), std::string::npos);
  }
}

TEST(ImageFile, AnAlteredByteIsFound) {
  const test::TemporaryFolder folder;
  ASSERT_TRUE(write_gray_png(folder / "a.png", ramp(20, 20)).ok());
  std::string bytes = slurp(folder / "a.png");
  bytes[bytes.size() / 2] = static_cast<char>(bytes[bytes.size() / 2] ^ 1);
  spill(folder / "a.png", bytes);
  EXPECT_EQ(read_gray_png(folder / "a.png").status().code, StatusCode::corrupt);
}

TEST(ImageFile, KindsAreNotConfused) {
  const test::TemporaryFolder folder;
  ASSERT_TRUE(write_color_png(folder / "c.png", gradient(20, 20)).ok());
  ASSERT_TRUE(write_gray_png(folder / "d.png", ramp(20, 20)).ok());
  EXPECT_EQ(read_gray_png(folder / "c.png").status().code, StatusCode::invalid_argument);
  EXPECT_EQ(read_color_image(folder / "none.png").status().code, StatusCode::not_found);
}

/// Cameras of 10 to 16 bits leave the upper ones 0.
TEST(ImageFile, GreyOf16BitsIsAPicture) {
  const test::TemporaryFolder folder;
  for (const int bits : {10, 12, 16}) {
    GrayImage image{3,
                    1,
                    {0, static_cast<std::uint16_t>(1 << (bits - 1)),
                     static_cast<std::uint16_t>((1 << bits) - 1)}};
    ASSERT_TRUE(write_gray_png(folder / "g.png", image).ok());
    const Result<ColorImage> grey = read_color_image(folder / "g.png");
    ASSERT_TRUE(grey.ok()) << grey.status().message;
    EXPECT_EQ(grey->pixels, (std::vector<std::uint8_t>{0, 0, 0, 128, 128, 128, 255, 255, 255}));
  }
}

TEST(ImageFile, AHugeJpegIsRefusedBeforeItIsDecoded) {
  const test::TemporaryFolder folder;
  // The frame header says 65535 x 65535 pixels (ITU-T T.81, B.2.2).
  spill(folder / "a.jpg",
        std::string("\xff\xd8\xff\xe0\0\x04..\xff\xc0\0\x11\x08", 13) + "\xff\xff\xff\xff\x03more");
  EXPECT_EQ(read_color_image(folder / "a.jpg").status().message,
            (folder / "a.jpg") + " has 65535x65535 pixels; each side must be 1 to 8192");
  spill(folder / "a.jpg", "\xff\xd8\xff\xe0");
  EXPECT_EQ(read_color_image(folder / "a.jpg").status().code, StatusCode::corrupt);
}

TEST(ImageFile, PixelsMayBeBounded) {
  const test::TemporaryFolder folder;
  ASSERT_TRUE(write_color_png(folder / "a.png", gradient(16, 16)).ok());
  const std::string bytes = slurp(folder / "a.png");
  const Result<ColorImage> image = decode_color_image(bytes, "a", 256);
  ASSERT_TRUE(image.ok()) << image.status().message;
  EXPECT_EQ(image->pixels, gradient(16, 16).pixels);
  EXPECT_EQ(decode_color_image(bytes, "a", 255).status().message,
            "a has 256 pixels; at most 255 can be read");
}

TEST(FrameFile, SizesMustAgree) {
  const test::TemporaryFolder folder;
  ASSERT_TRUE(write_color_png(folder / "c.png", gradient(40, 30)).ok());
  ASSERT_TRUE(write_gray_png(folder / "d.png", ramp(40, 30)).ok());
  ASSERT_TRUE(write_gray_png(folder / "small.png", ramp(20, 30)).ok());
  const Camera camera{0, 0, 50, 50, 20, 15};
  const Result<Frame> frame = read_frame(folder / "d.png", folder / "c.png", camera, 0.5);
  ASSERT_TRUE(frame.ok()) << frame.status().message;
  EXPECT_FLOAT_EQ(frame->depth[10], 610 * 0.0005f);
  EXPECT_EQ(frame->camera.width, 40);
  const Result<Frame> wrong = read_frame(folder / "small.png", folder / "c.png", camera, 1);
  ASSERT_FALSE(wrong.ok());
  EXPECT_NE(wrong.status().message.find("depth"), std::string::npos);
  EXPECT_NE(wrong.status().message.find("40x30"), std::string::npos);
}

std::string npy(const std::string& type, const std::string& shape, const std::string& data) {
  const std::string header =
      "{'descr': '" + type + "', 'fortran_order': False, 'shape': " + shape + ", }\n";
  return std::string("\x93NUMPY\x01\0", 8) + static_cast<char>(header.size()) +
         std::string(1, '\0') + header + data;
}

/// As NumPy and Netpbm write them, of the depths 1, 256 and 2 units, then 0.
TEST(DepthFile, ReadsNpyAndPgm) {
  const test::TemporaryFolder folder;
  const std::string little("\1\0\0\1\2\0\0\0", 8), big("\0\1\1\0\0\2\0\0", 8);
  const float metres[] = {0.5f, 0.25f, NAN, 0};
  const double doubles[] = {0.5, 0.25, NAN, 0};
  const std::string floats(reinterpret_cast<const char*>(metres), sizeof metres);
  const std::string wide(reinterpret_cast<const char*>(doubles), sizeof doubles);
  for (const std::string& bytes : {npy("<u2", "(2, 2)", little), npy(">u2", "(2, 2, 1)", big),
                                   "P5\n# a comment\n2 2\n65535\n" + big, "P5 2 2 1000\n" + big}) {
    spill(folder / "depth", bytes);
    const auto depth = read_depth(folder / "depth", 0.5);
    ASSERT_TRUE(depth.ok()) << depth.status().message;
    EXPECT_EQ(depth->width, 2);
    EXPECT_EQ(depth->metres, (std::vector<float>{0.0005f, 0.128f, 0.001f, 0}));
  }
  for (const std::string& bytes : {npy("<f4", "(1, 4)", floats), npy("<f8", "(1, 4)", wide)}) {
    spill(folder / "depth", bytes);
    const auto depth = read_depth(folder / "depth", 0.5);  // floats are metres whatever the unit
    ASSERT_TRUE(depth.ok()) << depth.status().message;
    EXPECT_EQ(depth->width, 4);
    EXPECT_EQ(depth->metres[1], 0.25f);
    EXPECT_TRUE(std::isnan(depth->metres[2]));
  }
}

/// As 32FC1 topics and clouds.
TEST(DepthFile, FloatsInMillimetresAreSaid) {
  const test::TemporaryFolder folder;
  const float depths[] = {631, 0, 900, 1200};
  spill(folder / "d.npy",
        npy("<f4", "(2, 2)", {reinterpret_cast<const char*>(depths), sizeof depths}));
  const auto depth = read_depth(folder / "d.npy", 1);
  ASSERT_TRUE(depth.ok()) << depth.status().message;
  EXPECT_FLOAT_EQ(depth->metres[0], 0.631f);
  EXPECT_EQ(depth->note, "depth is taken for millimetres: its median is 900");
}

TEST(DepthFile, RefusalsSayTheWayOut) {
  const test::TemporaryFolder folder;
  const auto refusal = [&](const std::string& name, const std::string& bytes) {
    spill(folder / name, bytes);
    const Status status = read_depth(folder / name, 1).status();
    EXPECT_FALSE(status.ok());
    return status.message;
  };
  const auto says = [&](const std::string& text, const char* words) {
    EXPECT_NE(text.find(words), std::string::npos) << text;
  };
  says(refusal("d.tiff", "II*         "), "numpy.save('depth.npy', cv2.imread('");
  says(refusal("d.exr", "v/1         "), "OPENCV_IO_ENABLE_OPENEXR=1");
  says(refusal("d.jpg", "\xff\xd8\xff\xe0    "), "it is a JPEG image, whose 8 bits hold no depths");
  says(refusal("d.ply", "ply\nformat ascii 1.0\n"), "it is a PLY file: a mesh or cloud");
  says(refusal("d.raw", "\1\2\3\4\5\6\7\10\11"), "numpy.fromfile('");
  says(refusal("d.xyz", "0 0 1 0 0 1"), "npy; give one of these");
  says(refusal("d.png", "<!DOCTYPE html><html>"), "it is a web page: its download failed");
  says(refusal("d.png", "version https://git-lfs.github.com/spec/v1\n"), "git lfs pull");
  says(refusal("d.bag", "#ROSBAG V2.0"), "rs-convert -i");
  says(refusal("d.mkv", "\x1a\x45\xdf\xa3        "), "azure_kinect_mkv_reader.py");
  says(refusal("d.pgm", "P5 2 2 255\nabcd"), "must have 16");
  says(refusal("d.pgm", "P5 2 2 65535\nabcd"), "must have 8");
  says(refusal("d.npy", npy("<f4", "(3, 4)", "abcd")), "must have 48");
  says(refusal("d.npy", npy("|u1", "(2, 2)", "abcd")), "\"|u1\"");
  says(refusal("d.npy", npy("<u2", "(2, 2, 3)", "abcd")), "one image");
  ASSERT_TRUE(write_mask_png(folder / "d.png", 2, 1, {1, 2}).ok());
  says(read_depth(folder / "d.png", 1).status().message, "must have 1 of 16: a picture");
  EXPECT_EQ(read_depth(folder / "none", 1).status().code, StatusCode::not_found);
}

}  // namespace
}  // namespace bpa::io
