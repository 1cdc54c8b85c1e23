// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "ros/bag_reader.hpp"

#include <algorithm>
#include <filesystem>
#include <utility>
#include <vector>

#include <yaml-cpp/yaml.h>
#include <zstd.h>

#include "core/base/concat.hpp"
#include "core/io/file_bytes.hpp"
#include "ros/private/bag_files.hpp"

namespace bpa::ros {
namespace {

namespace fs = std::filesystem;

Result<std::unique_ptr<BagReader>> open_file(const std::string& path) {
  const std::string extension = io::lower_extension(path);
  if (extension == "mcap") return open_mcap(path);
  if (extension == "db3") return open_sqlite_bag(path);
  if (extension == "zstd") {
    return Status(StatusCode::unsupported,
                  path + " is compressed as a whole; decompress it: unzstd \"" + path + "\"");
  }
  if (extension == "bag") {
    return Status(StatusCode::unsupported,
                  path +
                      " is a recording of ROS 1 or of a RealSense viewer; rosbags-convert of the "
                      "Python package rosbags makes one of ROS 2, rs-convert reads the other");
  }
  return Status(StatusCode::unsupported,
                path + " is no recording of ROS 2; it must be a .mcap or .db3 file, or its folder");
}

/// What metadata.yaml says; without it, the files that are there.
struct Listing {
  std::vector<std::string> files;
  bool messages_compressed = false;
};

Result<Listing> list_folder(const fs::path& folder) {
  Listing listing;
  const std::string metadata = folder / "metadata.yaml";
  if (io::is_file(metadata)) {
    try {
      const YAML::Node bag = YAML::LoadFile(metadata)["rosbag2_bagfile_information"];
      for (const YAML::Node& file : bag["relative_file_paths"]) {
        Result<std::string> path = io::path_below(folder, file.as<std::string>());
        if (!path.ok()) return path.status();
        listing.files.push_back(*std::move(path));
      }
      const auto mode = bag["compression_mode"].as<std::string>("");
      listing.messages_compressed = mode == "MESSAGE" || mode == "message";
    } catch (const YAML::Exception& error) {
      return corrupt(metadata, ": ", error.what());
    }
  } else {
    std::error_code error;
    for (const auto& entry : fs::directory_iterator(folder, error)) {
      const std::string extension = io::lower_extension(entry.path());
      if (extension == "mcap" || extension == "db3") listing.files.push_back(entry.path());
    }
    std::ranges::sort(listing.files);
  }
  if (listing.files.empty()) return not_found(folder.string(), " holds no .mcap or .db3 file");
  return listing;
}

/// The files of a folder, one after the other.
class FolderReader : public BagReader {
 public:
  FolderReader(Listing listing, std::unique_ptr<BagReader> first)
      : listing_(std::move(listing)), reader_(std::move(first)) {}

  Result<std::optional<BagMessage>> next() override {
    while (true) {
      Result<std::optional<BagMessage>> message = reader_->next();
      if (!message.ok()) return message;
      if (*message) return listing_.messages_compressed ? decompressed(**message) : message;
      if (++file_ >= listing_.files.size()) return message;
      auto reader = open_file(listing_.files[file_]);
      if (!reader.ok()) return reader.status();
      reader_ = std::move(reader).value();
    }
  }

 private:
  Result<std::optional<BagMessage>> decompressed(BagMessage message) {
    Result<std::string> plain = unzstd(message.bytes);
    if (!plain.ok()) {
      return corrupt(listing_.files[file_], ": a message of ", message.topic->name, ": ",
                     plain.status().message);
    }
    plain_ = std::move(plain).value();
    message.bytes = plain_;
    return std::optional(message);
  }

  const Listing listing_;
  std::size_t file_ = 0;
  std::unique_ptr<BagReader> reader_;
  std::string plain_;
};

}  // namespace

Result<std::string> unzstd(std::string_view bytes, std::optional<std::uint64_t> size) {
  const std::uint64_t content = size ? *size : ZSTD_getFrameContentSize(bytes.data(), bytes.size());
  if (content > kMostDecompressed) return corrupt("no zstd frame of a known size");
  // Blocks of 128 KiB have 4 bytes or more.
  if (content / 32768 > bytes.size()) return corrupt("its zstd frame is damaged");
  std::string plain(content, '\0');
  const std::size_t written =
      ZSTD_decompress(plain.data(), plain.size(), bytes.data(), bytes.size());
  if (written != content) return corrupt("its zstd frame is damaged");
  return plain;
}

Result<std::unique_ptr<BagReader>> open_bag(const std::string& path) {
  if (!io::is_folder(path)) return open_file(path);
  Result<Listing> listing = list_folder(path);
  if (!listing.ok()) return listing.status();
  auto first = open_file(listing->files.front());
  if (!first.ok()) return first.status();
  return std::unique_ptr<BagReader>(
      std::make_unique<FolderReader>(std::move(listing).value(), std::move(first).value()));
}

}  // namespace bpa::ros
