// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "idl/wire/cdr.hpp"

#include <algorithm>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "tests/idl/wire/all_types.hpp"
#include "tests/idl/wire/fill.hpp"
#include "tests/idl/wire/sequences.hpp"

namespace bpa::wire {
namespace {

using Bytes = std::vector<std::uint8_t>;

/// The rules of XCDR1 a second time, in plain words and in big-endian order.
class BigEndianWriter {
 public:
  Bytes bytes = {0, 0, 0, 0};

  template <class T>
  void operator()(const char*, const T& value, Bound = {}) {
    write(value);
  }

  template <class T>
  void write(const T& value) {
    if constexpr (detail::is_scalar_v<T>) {
      while ((bytes.size() - 4) % sizeof(T) != 0) bytes.push_back(0);
      Bytes raw(sizeof(T));
      std::memcpy(raw.data(), &value, sizeof(T));
      bytes.insert(bytes.end(), raw.rbegin(), raw.rend());
    } else if constexpr (std::is_same_v<T, std::string>) {
      write(static_cast<std::uint32_t>(value.size() + 1));
      bytes.insert(bytes.end(), value.begin(), value.end());
      bytes.push_back(0);
    } else if constexpr (detail::is_vector<T>::value) {
      write(static_cast<std::uint32_t>(value.size()));
      for (const auto& element : value) write<typename T::value_type>(element);
    } else if constexpr (detail::is_array<T>::value) {
      for (const auto& element : value) write(element);
    } else {
      T::fields(value, *this);
    }
  }
};

/// Adds up what a message holds: its scalars, and the contents of its strings and sequences.
class HeldBytes {
 public:
  std::size_t bytes = 0;

  template <class T>
  void operator()(const char*, const T& value, Bound = {}) {
    add(value);
  }

  template <class T>
  void add(const T& value) {
    if constexpr (detail::is_scalar_v<T>) {
      bytes += sizeof(T);
    } else if constexpr (std::is_same_v<T, std::string>) {
      bytes += value.size();
    } else if constexpr (detail::is_vector<T>::value || detail::is_array<T>::value) {
      for (const auto& element : value) add<typename T::value_type>(element);
    } else {
      T::fields(value, *this);
    }
  }
};

template <class T>
std::size_t bytes_held(const T& message) {
  HeldBytes held;
  held.add(message);
  return held.bytes;
}

TEST(Cdr, BytesOfAHeader) {
  std_msgs::Header header;
  header.stamp = {1, 2};
  header.frame_id = "ab";
  const Bytes expected = {0, 1, 0, 0, 1, 0, 0, 0, 2, 0, 0, 0, 3, 0, 0, 0, 'a', 'b', 0};
  EXPECT_EQ(encode(header), expected);
}

TEST(Cdr, EmptyRequestIsOneByte) {
  EXPECT_EQ(encode(std_srvs::Trigger_Request{}), (Bytes{0, 1, 0, 0, 0}));
}

TEST(Cdr, EveryTypeComesBackInBothByteOrders) {
  for_each_type([](const auto* type) {
    using T = std::decay_t<decltype(*type)>;
    for (unsigned seed = 0; seed < 20; ++seed) {
      const T message = filled<T>(seed);
      const Bytes bytes = encode(message);
      ASSERT_EQ(bytes.size(), encoded_size(message)) << T::kType;
      T little, big;
      const Status status = decode(bytes.data(), bytes.size(), little);
      ASSERT_TRUE(status.ok()) << status.message;
      EXPECT_EQ(encode(little), bytes) << T::kType;

      BigEndianWriter writer;
      writer.write(message);
      ASSERT_EQ(writer.bytes.size(), bytes.size()) << T::kType;
      ASSERT_TRUE(decode(writer.bytes.data(), writer.bytes.size(), big).ok()) << T::kType;
      EXPECT_EQ(encode(big), bytes) << T::kType;
    }
  });
}

TEST(Cdr, EveryTruncationIsAnErrorThatNamesTheField) {
  for_each_type([](const auto* type) {
    using T = std::decay_t<decltype(*type)>;
    const Bytes bytes = encode(filled<T>(3));
    for (std::size_t size = 0; size < bytes.size(); ++size) {
      const Bytes part(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size));
      T message;
      const Status status = decode(part.data(), part.size(), message);
      ASSERT_EQ(status.code, StatusCode::corrupt) << T::kType << " of " << size;
      ASSERT_NE(status.message.find(T::kType), std::string::npos) << status.message;
    }
  });
}

TEST(Cdr, AnyByteMayBeWrong) {
  int refused = 0;
  for_each_type([&refused](const auto* type) {
    using T = std::decay_t<decltype(*type)>;
    const Bytes bytes = encode(filled<T>(5));
    for (std::size_t at = 0; at < bytes.size(); ++at) {
      for (const std::uint8_t value : {0x00, 0x7f, 0xff}) {
        Bytes wrong = bytes;
        wrong[at] = value;
        T message;
        const Status status = decode(wrong.data(), wrong.size(), message);
        if (!status.ok()) {
          ++refused;
          ASSERT_EQ(status.code, StatusCode::corrupt) << T::kType << " byte " << at;
          ASSERT_EQ(status.message.rfind(T::kType, 0), 0U) << status.message;
          continue;
        }
        // Whatever was read comes from these bytes, each of them read once, and is legal itself.
        ASSERT_LE(bytes_held(message), wrong.size() - kCdrHeaderSize) << T::kType << " byte " << at;
        const Bytes once = encode(message);
        T again;
        ASSERT_TRUE(decode(once.data(), once.size(), again).ok()) << T::kType << " byte " << at;
        ASSERT_EQ(encode(again), once) << T::kType << " byte " << at;
      }
    }
  });
  EXPECT_GT(refused, 100);
}

TEST(Cdr, ALengthIsNotBelievedBeforeTheBytesAreThere) {
  // 4 GB of names and 4 G placements, in a few bytes.
  rcl_interfaces::ListParameters_Request names;
  const Bytes claim = {0, 1, 0, 0, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff, 0xff};
  const Status status = decode(claim.data(), claim.size(), names);
  EXPECT_EQ(status.code, StatusCode::corrupt);
  EXPECT_NE(status.message.find("prefixes"), std::string::npos) << status.message;

  sensor_msgs::Image image;
  Bytes bytes = encode(image);
  std::fill(bytes.end() - 4, bytes.end(), std::uint8_t{0xff});
  EXPECT_EQ(decode(bytes.data(), bytes.size(), image).code, StatusCode::corrupt);
}

TEST(Cdr, BoundsAreKeptBothWays) {
  rmw_dds_common::NodeEntitiesInfo info;
  info.node_name.assign(256, 'x');
  EXPECT_FALSE(encode(info).empty());
  info.node_name.assign(257, 'x');
  EXPECT_TRUE(encode(info).empty());

  rcl_interfaces::ParameterDescriptor descriptor;
  const Bytes none = encode(descriptor);
  descriptor.integer_range.resize(2);
  EXPECT_TRUE(encode(descriptor).empty());
  Bytes two = none;
  two[two.size() - 4] = 2;  // the count of the last field
  two.resize(two.size() + 100);
  const Status status = decode(two.data(), two.size(), descriptor);
  EXPECT_NE(status.message.find("bound"), std::string::npos) << status.message;
}

TEST(Cdr, PaddingAtTheEndAndForeignEncodings) {
  std_msgs::String text;
  text.data = "abc";
  Bytes bytes = encode(text);
  bytes.resize(bytes.size() + 3);
  EXPECT_TRUE(decode(bytes.data(), bytes.size(), text).ok());
  EXPECT_EQ(text.data, "abc");
  bytes[1] = 3;  // PL_CDR_LE
  EXPECT_EQ(decode(bytes.data(), bytes.size(), text).code, StatusCode::corrupt);
}

TEST(Cdr, ViewAndFrameAreTheSameOnTheWire) {
  bpa_msgs::RgbdFrame frame = filled<bpa_msgs::RgbdFrame>(8);
  frame.color = {1, 2, 3, 4, 5};
  bpa_msgs::RgbdFrameView view;
  view.header = frame.header;
  view.width = frame.width;
  view.height = frame.height;
  view.color_encoding = frame.color_encoding;
  view.color = {frame.color.data(), frame.color.size()};
  view.depth_encoding = frame.depth_encoding;
  view.depth = {frame.depth.data(), frame.depth.size()};
  view.k = frame.k;
  view.d = frame.d;
  view.roi = frame.roi;
  view.mask = {frame.mask.data(), frame.mask.size()};
  view.priors = frame.priors;
  EXPECT_EQ(encode(view), encode(frame));
}

TEST(Cdr, TooLittleMemoryWritesNothingBeyondIt) {
  const auto message = filled<bpa_msgs::Placement>(1);
  const std::size_t size = encoded_size(message);
  for (std::size_t capacity = 0; capacity < size; ++capacity) {
    Bytes memory(capacity + 1, 0xaa);
    EXPECT_EQ(encode(message, memory.data(), capacity), 0U);
    EXPECT_EQ(memory[capacity], 0xaa);
  }
}

}  // namespace
}  // namespace bpa::wire
