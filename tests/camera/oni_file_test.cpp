// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// What is written can be inspected; what is damaged is refused. That OpenNI2 plays what is written
// is shown by tests/system/openni.
#include "camera/oni_file.hpp"

#include <gtest/gtest.h>

#include "tests/support/temporary_folder.hpp"

namespace bpa::camera {
namespace {

constexpr std::uint32_t kWidth = 8, kHeight = 6;
using Kind = OniStreamInfo::Kind;

class OniFile : public ::testing::Test {
 protected:
  /// A recording of 3 frames.
  std::string write(bool finish = true) {
    const std::string path = folder_ / "a.oni";
    const OniStreamFormat depth{Kind::depth, kWidth, kHeight, 30,    100, 2 * kWidth * kHeight,
                                10000,       1.0,    0.8,     false, 2.5};
    const OniStreamFormat color{Kind::color, kWidth, kHeight, 30,    200, 3 * kWidth * kHeight,
                                0,           1.0,    0.8,     false, 0};
    auto writer = OniWriter::create(path, {depth, color}, true);
    EXPECT_TRUE(writer.ok()) << writer.status().message;
    const std::vector<std::uint8_t> pixels(3 * kWidth * kHeight, 9);
    for (int i = 0; i < 3; ++i) {
      EXPECT_TRUE(writer->add(0, 5000 + 33 * i, pixels.data(), depth.frame_bytes).ok());
      EXPECT_TRUE(writer->add(1, 5000 + 33 * i, pixels.data(), color.frame_bytes).ok());
    }
    EXPECT_EQ(writer->add(0, 9000, pixels.data(), 5).code, StatusCode::invalid_argument);
    if (finish) {
      EXPECT_TRUE(writer->finish().ok());
    }
    return path;
  }
  /// Fails with `code`, naming the file and all the words.
  void expect_refusal(StatusCode code, const std::vector<std::string>& words) {
    const auto info = inspect_oni_file(folder_ / "a.oni");
    ASSERT_FALSE(info.ok());
    EXPECT_EQ(info.status().code, code) << info.status().message;
    EXPECT_NE(info.status().message.find("a.oni"), std::string::npos);
    for (const std::string& word : words) {
      EXPECT_NE(info.status().message.find(word), std::string::npos) << info.status().message;
    }
  }
  void spoil(std::size_t from_end, char byte) {
    std::string bytes = test::slurp(folder_ / "a.oni");
    bytes[bytes.size() - from_end] = byte;
    test::spill(folder_ / "a.oni", bytes);
  }

  test::TemporaryFolder folder_;
};

TEST_F(OniFile, WhatIsWrittenIsFound) {
  const auto info = inspect_oni_file(write());
  ASSERT_TRUE(info.ok()) << info.status().message;
  ASSERT_EQ(info->streams.size(), 2U);
  EXPECT_EQ(info->registered, OniFileInfo::Registered::yes);
  for (const Kind kind : {Kind::depth, Kind::color}) {
    const OniStreamInfo* stream = info->find(kind);
    ASSERT_NE(stream, nullptr);
    EXPECT_EQ(stream->frames, 3U);
    EXPECT_EQ(stream->width, kWidth);
    EXPECT_EQ(stream->height, kHeight);
    EXPECT_EQ(stream->fps, 30U);
  }
  EXPECT_EQ(info->find(Kind::infrared), nullptr);
}

TEST_F(OniFile, EveryTruncationIsRefused) {
  const std::string bytes = test::slurp(write());
  for (std::size_t size = 0; size < bytes.size(); ++size) {
    test::spill(folder_ / "a.oni", bytes.substr(0, size));
    const auto info = inspect_oni_file(folder_ / "a.oni");
    ASSERT_FALSE(info.ok()) << size;
    ASSERT_EQ(info.status().code, StatusCode::corrupt) << size << info.status().message;
  }
  test::spill(folder_ / "a.oni", bytes.substr(0, bytes.size() - 28));
  expect_refusal(StatusCode::corrupt, {"truncated", "after 3 frames"});
}

TEST_F(OniFile, ARecordingThatWasNotFinishedIsTruncated) {
  write(false);
  EXPECT_EQ(inspect_oni_file(folder_ / "a.oni").status().code, StatusCode::not_found);
  std::filesystem::rename(folder_ / "a.oni.part", folder_ / "a.oni");
  expect_refusal(StatusCode::corrupt, {"truncated", "after 3 frames"});
}

TEST_F(OniFile, AFullDiskIsNamedAndWhatWasWrittenStaysBeside) {
  std::filesystem::create_symlink("/dev/full", folder_ / "a.oni.part");
  const OniStreamFormat depth{Kind::depth, kWidth, kHeight, 30,    100, 2 * kWidth * kHeight,
                              10000,       1.0,    0.8,     false, 2.5};
  auto writer = OniWriter::create(folder_ / "a.oni", {depth}, true);
  const Status status = writer.ok() ? writer->finish() : writer.status();
  EXPECT_EQ(status.code, StatusCode::unavailable);
  for (const char* words : {"a.oni cannot be written", "No space left on device", "a.oni.part"}) {
    EXPECT_NE(status.message.find(words), std::string::npos) << status.message;
  }
  EXPECT_FALSE(std::filesystem::exists(folder_ / "a.oni"));
}

TEST_F(OniFile, DamagedRecordsAreRefused) {
  write();
  spoil(28, 'X');  // the magic of the last record
  expect_refusal(StatusCode::corrupt, {"damaged", "record at byte"});
  write();
  spoil(24, 0x55);  // its type
  expect_refusal(StatusCode::corrupt, {"damaged", "record at byte"});
  test::spill(folder_ / "a.oni", std::string(500, 'z'));
  expect_refusal(StatusCode::corrupt, {"no OpenNI recording"});
}

TEST_F(OniFile, NoDamageOfAnyByteIsMistakenForAnotherSize) {
  // Whatever byte is wrong, inspecting comes to an end, and what it says stays in bounds.
  const std::string bytes = test::slurp(write());
  int refused = 0;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::string changed = bytes;
    changed[i] = static_cast<char>(changed[i] ^ 0xFF);
    test::spill(folder_ / "a.oni", changed);
    const auto info = inspect_oni_file(folder_ / "a.oni");
    if (!info.ok()) {
      ++refused;
      continue;
    }
    for (const OniStreamInfo& stream : info->streams) ASSERT_EQ(stream.frames, 3U) << i;
  }
  EXPECT_GT(refused, 100);  // all headers and sizes; pixels and times may be anything
}

TEST_F(OniFile, OldFormatsAndMissingFilesAreNamed) {
  std::string bytes = test::slurp(write());
  bytes[6] = 0;  // 1.0.0
  test::spill(folder_ / "a.oni", bytes);
  expect_refusal(StatusCode::unsupported, {"1.0.0"});
  EXPECT_EQ(inspect_oni_file(folder_ / "none.oni").status().code, StatusCode::not_found);
  EXPECT_EQ(OniWriter::create(folder_ / "none/a.oni", {}, false).status().code,
            StatusCode::unavailable);
  const OniStreamFormat large{Kind::depth, 4000, 3000, 30, 100, 24'000'000, 0, 1, 1, false, 0};
  EXPECT_EQ(OniWriter::create(folder_ / "b.oni", {large}, false).status().code,
            StatusCode::unsupported);
}

}  // namespace
}  // namespace bpa::camera
