// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// The only file of this room that sees PCL, of which it takes the decompression. pcl::PCDReader
// trusts headers: it crashes on a field without a type.
#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cstring>
#include <iterator>
#include <map>
#include <optional>
#include <sstream>
#include <string_view>

#include <pcl/io/lzf.h>

#include "core/base/concat.hpp"
#include "core/io/file_bytes.hpp"
#include "core/io/pcd_file.hpp"

namespace bpa::io {
namespace {

constexpr std::uint64_t kMaxPoints = 50'000'000;
constexpr std::size_t kMaxFields = 1000;
constexpr std::size_t kMaxCount = 10'000;  // of one field; VFH has 308

struct Field {
  std::string name;
  char type = 'F';  ///< F, I or U.
  std::size_t size = 4;
  std::size_t count = 1;
  std::size_t offset = 0;  ///< In a point, bytes.
  std::size_t column = 0;  ///< Of its first value, in a line.

  bool of_four_bytes() const { return size == 4 && count == 1; }
};

struct Header {
  std::vector<Field> fields;
  std::uint64_t width = 0, height = 1, points = 0;
  std::string data;       ///< ascii, binary or binary_compressed.
  std::size_t bytes = 0;  ///< Of the header, to the first point.
  std::size_t point_bytes = 0;
  std::size_t columns = 0;  ///< Values of a point.

  const Field* find(std::string_view name) const {
    const auto field = std::ranges::find(fields, name, &Field::name);
    return field == fields.end() ? nullptr : &*field;
  }
};

std::vector<std::string> words_of(std::string_view line) {
  std::istringstream in{std::string(line)};
  return {std::istream_iterator<std::string>(in), {}};
}

template <class Number>
std::optional<Number> number_of(std::string_view word) {
  Number number{};
  if (word.starts_with('+')) word.remove_prefix(1);
  const char* const end = word.data() + word.size();
  const auto [stopped, error] = std::from_chars(word.data(), end, number);
  if (word.empty() || error != std::errc() || stopped != end) return std::nullopt;
  return number;
}

/// The lines of a header, word by word, by their keys. Each key stands once.
class HeaderLines {
 public:
  HeaderLines(std::string_view bytes, const std::string& path) : path_(path) {
    while (end_ < bytes.size() && status_.ok() && find("DATA") == nullptr) {
      constexpr std::size_t kMaxLine = 4096;
      const std::size_t newline = bytes.find('\n', end_);
      const std::size_t length = std::min(newline, bytes.size()) - end_;
      if (length > kMaxLine) break;
      add(words_of(bytes.substr(end_, length)));
      end_ = std::min(bytes.size(), end_ + length + 1);
    }
    for (const char* key : {"FIELDS", "SIZE", "TYPE", "WIDTH", "POINTS", "DATA"}) {
      if (status_.ok() && !find(key)) status_ = corrupt(path, " is not a PCD file: no ", key);
    }
  }

  const Status& status() const { return status_; }
  std::size_t end() const { return end_; }
  /// What stands behind a key; null without the key.
  const std::vector<std::string>* find(const std::string& key) const {
    const auto line = lines_.find(key);
    return line == lines_.end() ? nullptr : &line->second;
  }

  void read_number(const char* key, std::uint64_t& number) {
    const auto* words = find(key);
    if (words == nullptr || !status_.ok()) return;
    const auto value = words->size() == 1 ? number_of<std::uint64_t>(words->front()) : std::nullopt;
    if (value) {
      number = *value;
    } else {
      status_ = corrupt(path_, " has a PCD header whose ", key, " is not a number");
    }
  }

 private:
  void add(std::vector<std::string> words) {
    if (words.empty() || words[0][0] == '#') return;
    std::string key = words[0] == "COLUMNS" ? "FIELDS" : words[0];
    words.erase(words.begin());
    constexpr const char* kKeys[] = {"VERSION", "FIELDS", "SIZE",   "TYPE", "COUNT",
                                     "WIDTH",   "HEIGHT", "POINTS", "DATA", "VIEWPOINT"};
    if (std::ranges::count(kKeys, key) == 0) {
      // What cannot be printed stays away from terminals.
      const auto printable = [](unsigned char c) { return c > 32 && c < 127; };
      key.erase(std::ranges::find_if_not(key, printable), key.end());
      key.resize(std::min<std::size_t>(20, key.size()));
      status_ =
          corrupt(path_, " is not a PCD file: its header has a line that begins with \"", key,
                  "\". A frame is an organised PCD cloud, which has rows of pixels, or a depth "
                  "image (--depth FILE --camera FILE)");
    } else if (!lines_.emplace(std::move(key), std::move(words)).second) {
      status_ = corrupt(path_, " has a PCD header with a line twice");
    }
  }

  const std::string& path_;
  std::map<std::string, std::vector<std::string>> lines_;
  std::size_t end_ = 0;
  Status status_;
};

/// Types, sizes and places of the fields.
Status read_fields(const HeaderLines& lines, const std::string& path, Header& header) {
  const std::vector<std::string>&names = *lines.find("FIELDS"), &sizes = *lines.find("SIZE"),
        &types = *lines.find("TYPE");
  const std::vector<std::string>* counts = lines.find("COUNT");
  const std::size_t n = names.size();
  if (n == 0 || n > kMaxFields || sizes.size() != n || types.size() != n ||
      (counts != nullptr && counts->size() != n)) {
    return corrupt(path, " has a PCD header with ", n,
                   " FIELDS; SIZE, TYPE and COUNT must have as many words, 1 to ", kMaxFields);
  }
  for (std::size_t i = 0; i < n; ++i) {
    const auto size = number_of<std::size_t>(sizes[i]);
    const auto count = counts != nullptr ? number_of<std::size_t>((*counts)[i]) : 1;
    const bool sized = size && (*size == 1 || *size == 2 || *size == 4 || *size == 8);
    const bool typed = types[i] == "F" || types[i] == "I" || types[i] == "U";
    if (!sized || !typed || !count || *count > kMaxCount) {
      return corrupt(path, " has a PCD header whose field ", i + 1,
                     " has no legal SIZE (1, 2, 4, 8), TYPE (F, I, U) or COUNT (at most ",
                     kMaxCount, ")");
    }
    header.fields.push_back(
        {names[i], types[i][0], *size, *count, header.point_bytes, header.columns});
    header.point_bytes += *size * *count;
    header.columns += *count;
  }
  return {};
}

Result<Header> parse_header(std::string_view bytes, const std::string& path) {
  Header header;
  HeaderLines lines(bytes, path);
  lines.read_number("WIDTH", header.width);
  lines.read_number("HEIGHT", header.height);
  lines.read_number("POINTS", header.points);
  if (!lines.status().ok()) return lines.status();
  header.bytes = lines.end();
  const std::vector<std::string>& data = *lines.find("DATA");
  header.data = data.empty() ? "" : data.front();
  if (header.width > kMaxPoints || header.height > kMaxPoints ||
      header.width * header.height != header.points) {
    return corrupt(path, " has a PCD header whose POINTS is not WIDTH x HEIGHT");
  }
  if (header.points == 0 || header.points > kMaxPoints) {
    return invalid_argument(path, " has ", header.points, " points; it must have 1 to ",
                            kMaxPoints);
  }
  if (Status status = read_fields(lines, path, header); !status.ok()) return status;
  return header;
}

/// Hands out the fields of the points, whichever way they are stored.
class Points {
 public:
  /// Fails with corrupt where the bytes are not those of all points.
  static Result<Points> read(const Header& header, std::string_view bytes,
                             const std::string& path) {
    Points points(header);
    const Status damaged = corrupt(path, " is truncated or damaged");
    const std::uint64_t needed = header.points * header.point_bytes;
    if (header.data == "binary") {
      if (bytes.size() < needed) return damaged;
      points.stored_ = bytes.substr(0, needed);
    } else if (header.data == "binary_compressed") {
      if (!points.decompress(bytes, needed)) return damaged;
    } else if (header.data == "ascii") {
      if (!points.parse(bytes)) return damaged;
    } else {
      return corrupt(path, " has the PCD data \"", header.data.substr(0, 20),
                     "\"; it must be ascii, binary or binary_compressed");
    }
    return points;
  }

  /// Of a field of four bytes.
  std::uint32_t bits(std::size_t point, const Field& field) const {
    std::uint32_t bits = 0;
    std::memcpy(&bits, place(point, field), sizeof bits);
    return bits;
  }

 private:
  explicit Points(const Header& header) : header_(&header) {}

  const char* place(std::size_t point, const Field& field) const {
    const std::size_t count = header_->points;
    if (!own_.empty() && by_field_) return own_.data() + field.offset * count + point * field.size;
    return (own_.empty() ? stored_.data() : own_.data()) + point * header_->point_bytes +
           field.offset;
  }

  /// Two sizes, then the fields one after the other.
  bool decompress(std::string_view bytes, std::uint64_t needed) {
    std::uint32_t sizes[2] = {};              // compressed, and not
    constexpr std::uint64_t kMaxRatio = 100;  // of LZF: 264 bytes from 3
    if (bytes.size() < sizeof sizes) return false;
    std::memcpy(sizes, bytes.data(), sizeof sizes);
    bytes.remove_prefix(sizeof sizes);
    if (sizes[0] > bytes.size() || sizes[1] != needed || needed / kMaxRatio > sizes[0]) {
      return false;
    }
    own_.resize(needed);
    by_field_ = true;
    return pcl::lzfDecompress(bytes.data(), sizes[0], own_.data(), sizes[1]) == needed;
  }

  /// One point a line. Only fields of four bytes are kept.
  bool parse(std::string_view bytes) {
    // Each value has a character and another one behind it, but for the last one.
    if (header_->points * header_->columns > (bytes.size() + 1) / 2) return false;
    for (std::size_t i = 0; i < header_->points;) {
      if (bytes.empty()) return false;
      const std::size_t length = std::min(bytes.find('\n'), bytes.size());
      const std::vector<std::string> words = words_of(bytes.substr(0, length));
      bytes.remove_prefix(std::min(bytes.size(), length + 1));
      if (words.empty()) continue;
      if (words.size() != header_->columns) return false;
      if (own_.empty()) own_.resize(header_->points * header_->point_bytes);
      for (const Field& field : header_->fields) {
        if (field.of_four_bytes() && !parse(words[field.column], i, field)) return false;
      }
      ++i;
    }
    return true;
  }
  bool parse(std::string_view word, std::size_t point, const Field& field) {
    char* to = own_.data() + point * header_->point_bytes + field.offset;
    const auto store = [to](const auto& number) {
      if (number) std::memcpy(to, &*number, sizeof *number);
      return number.has_value();
    };
    if (field.type == 'F') return store(number_of<float>(word));
    if (field.type == 'I') return store(number_of<std::int32_t>(word));
    return store(number_of<std::uint32_t>(word));
  }

  const Header* header_;
  std::string_view stored_;
  std::vector<char> own_;  ///< Decompressed or parsed.
  bool by_field_ = false;
};

/// Three float fields as vectors; empty unless all are there.
std::vector<Eigen::Vector3f> read_vectors(const Header& header, const Points& points,
                                          std::array<const char*, 3> names) {
  std::array<const Field*, 3> fields;
  for (std::size_t k = 0; k < 3; ++k) {
    fields[k] = header.find(names[k]);
    if (!fields[k] || !fields[k]->of_four_bytes() || fields[k]->type != 'F') return {};
  }
  std::vector<Eigen::Vector3f> vectors(header.points);
  for (std::size_t i = 0; i < vectors.size(); ++i) {
    for (std::size_t k = 0; k < 3; ++k) {
      vectors[i][static_cast<int>(k)] = std::bit_cast<float>(points.bits(i, *fields[k]));
    }
  }
  return vectors;
}

std::vector<std::array<std::uint8_t, 3>> read_colors(const Header& header, const Points& points) {
  const Field* field = header.find("rgb");
  if (field == nullptr) field = header.find("rgba");
  if (field == nullptr || !field->of_four_bytes()) return {};
  std::vector<std::array<std::uint8_t, 3>> colors(header.points);
  for (std::size_t i = 0; i < colors.size(); ++i) {
    const std::uint32_t packed = points.bits(i, *field);  // 0xAARRGGBB
    colors[i] = {static_cast<std::uint8_t>(packed >> 16), static_cast<std::uint8_t>(packed >> 8),
                 static_cast<std::uint8_t>(packed)};
  }
  return colors;
}

}  // namespace

Result<PcdCloud> parse_pcd(std::string_view bytes, const std::string& name) {
  const Result<Header> header = parse_header(bytes, name);
  if (!header.ok()) return header.status();
  const Result<Points> points = Points::read(*header, bytes.substr(header->bytes), name);
  if (!points.ok()) return points.status();
  PcdCloud cloud;
  cloud.width = static_cast<int>(header->width);
  cloud.height = static_cast<int>(header->height);
  cloud.points = read_vectors(*header, *points, {"x", "y", "z"});
  if (cloud.points.empty()) return invalid_argument(name, " has no float fields x, y and z");
  cloud.normals = read_vectors(*header, *points, {"normal_x", "normal_y", "normal_z"});
  cloud.colors = read_colors(*header, *points);
  return cloud;
}

Result<PcdCloud> read_pcd(const std::string& path) {
  if (!is_file(path)) return not_found(path, " cannot be opened");
  const Result<std::string> bytes = read_file(path);
  if (!bytes.ok()) return bytes.status();
  return parse_pcd(*bytes, path);
}

}  // namespace bpa::io
