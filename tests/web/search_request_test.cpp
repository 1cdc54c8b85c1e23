// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "server/web/search_request.hpp"

#include <gtest/gtest.h>

#include "core/io/image_file.hpp"
#include "server/web/to_json.hpp"

namespace bpa::server::web {
namespace {

std::shared_ptr<const Frame> frame() {
  Frame frame;
  frame.camera = {64, 48, 60, 60, 31.5, 23.5};
  frame.depth.assign(64 * 48, 1.5f);
  return std::make_shared<const Frame>(std::move(frame));
}

Result<Frame> searched(const std::string& json) {
  auto job = search_job(json, frame(), {});
  if (!job.ok()) return job.status();
  return std::move(job->decode)();
}

TEST(SearchJob, HasWhatWasAskedFor) {
  const auto job =
      search_job(R"({"models": ["mug"], "top_k": 3, "budget_ms": 70, "seed": 5})", nullptr, {});
  ASSERT_TRUE(job.ok()) << job.status().message;
  EXPECT_EQ(job->request.models, std::vector<std::string>{"mug"});
  EXPECT_EQ(job->request.top_k, 3);
  EXPECT_EQ(job->request.budget_ms, 70);
  EXPECT_EQ(job->request.seed, 5U);
  EXPECT_FALSE(job->decode);  // the camera's next frame
  EXPECT_EQ(search_job("", nullptr, {})->request.top_k, DetectionOptions().top_k);
}

TEST(SearchJob, HasTheRegion) {
  const auto made = searched(R"({"region": [3, 4, 20, 10]})");
  ASSERT_TRUE(made.ok()) << made.status().message;
  EXPECT_EQ(made->roi.x, 3);
  EXPECT_EQ(made->roi.y, 4);
  EXPECT_EQ(made->roi.width, 20);
  EXPECT_EQ(made->roi.height, 10);
}

TEST(SearchJob, MaskIsTheInsideOfThePolygon) {
  const auto made = searched(R"({"polygon": [[5, 5], [45, 5], [45, 40], [5, 40]]})");
  ASSERT_TRUE(made.ok()) << made.status().message;
  ASSERT_EQ(made->mask.size(), 64U * 48U);
  for (int v = 0; v < 48; ++v) {
    for (int u = 0; u < 64; ++u) {
      const bool inside = u >= 5 && u <= 45 && v >= 5 && v <= 40;
      EXPECT_EQ(made->mask[static_cast<std::size_t>(64 * v + u)] != 0, inside) << u << ' ' << v;
    }
  }
}

TEST(SearchJob, RefusesWhatBreaksARule) {
  for (const char* wrong :
       {"[1]", "{", R"({"top_k": "many"})", R"({"top_k": 1000})", R"({"budget_ms": -1})",
        R"({"models": 5})", R"({"region": [1, 2, 3]})", R"({"region": [-5, 0, 10, 10]})",
        R"({"region": [0, 0, 65, 10]})", R"({"region": [2000000000, 0, 2000000000, 10]})",
        R"({"polygon": [[1, 2], [3, 4]]})", R"({"polygon": [[1e9, 2], [3, 4], [5, 6]]})",
        R"({"polygon": "all"})"}) {
    const auto made = searched(wrong);
    ASSERT_FALSE(made.ok()) << wrong;
    EXPECT_EQ(made.status().code, StatusCode::invalid_argument) << wrong;
    EXPECT_FALSE(made.status().message.empty());
  }
}

TEST(SearchJob, RefusesDeepJson) {
  const std::string deep(30000, '[');
  EXPECT_FALSE(searched(deep + std::string(30000, ']')).ok());
  EXPECT_FALSE(searched("{\"models\": " + deep + std::string(30000, ']') + "}").ok());
  const auto parameter = parameter_from_json("{\"name\": \"detection.top_k\", \"value\": " + deep +
                                             std::string(30000, ']') + "}");
  ASSERT_FALSE(parameter.ok());
  EXPECT_NE(parameter.status().message.find("must be of type integer"), std::string::npos);
}

Request upload_of(const Frame& like, const std::string& depth, const std::string& color) {
  Request request;
  request.query = {{"kind", "png"},
                   {"depth_bytes", std::to_string(depth.size())},
                   {"fx", std::to_string(like.camera.fx)},
                   {"fy", std::to_string(like.camera.fy)},
                   {"cx", std::to_string(like.camera.cx)},
                   {"cy", std::to_string(like.camera.cy)}};
  request.body = depth + color;
  return request;
}

class Upload : public testing::Test {
 protected:
  const io::GrayImage depth{64, 48, std::vector<std::uint16_t>(64 * 48, 1234)};
  const io::ColorImage color{64, 48, std::vector<std::uint8_t>(3 * 64 * 48, 77)};
  const std::string depth_png = *io::encode_gray_png(depth);
  const std::string color_png = *io::encode_color_png(color);
};

TEST_F(Upload, OfPngsIsTheFrame) {
  const auto made = uploaded_frame(upload_of(*frame(), depth_png, color_png), 2.5);
  ASSERT_TRUE(made.ok()) << made.status().message;
  EXPECT_EQ(made->camera.width, 64);
  EXPECT_EQ(made->camera.cx, 31.5);
  EXPECT_EQ(made->color, color.pixels);
  for (const float z : made->depth) EXPECT_FLOAT_EQ(z, 1.234f);
  Request half = upload_of(*frame(), depth_png, "");
  half.query["depth_scale_mm"] = "0.5";
  const auto without = uploaded_frame(half, 2.5);
  ASSERT_TRUE(without.ok());
  EXPECT_TRUE(without->color.empty());
  EXPECT_FLOAT_EQ(without->depth[0], 0.617f);
}

TEST_F(Upload, OfACloudIsTheFrame) {
  std::string points;
  for (int v = 0; v < 48; ++v) {
    for (int u = 0; u < 64; ++u) {
      const double z = 1 + 0.01 * u;
      points += std::to_string((u - 31.5) / 60 * z) + " " + std::to_string((v - 23.5) / 60 * z) +
                " " + std::to_string(z) + "\n";
    }
  }
  Request request;
  request.query = {{"kind", "pcd"}};
  request.body =
      "VERSION .7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 64\nHEIGHT 48\n"
      "VIEWPOINT 0 0 0 1 0 0 0\nPOINTS 3072\nDATA ascii\n" +
      points;
  const auto made = uploaded_frame(request, 2.5);
  ASSERT_TRUE(made.ok()) << made.status().message;
  EXPECT_NEAR(made->camera.fx, 60, 0.1);
  EXPECT_NEAR(made->depth[10], 1.1, 1e-4);
}

TEST_F(Upload, RefusesWhatBreaksARule) {
  const Frame like = *frame();
  Request request = upload_of(like, depth_png, color_png);
  const auto refused = [](Request wrong) {
    const auto made = uploaded_frame(wrong, 2.5);
    EXPECT_FALSE(made.ok());
    return made.status().message;
  };
  const auto with = [&](const char* name, const char* value) {
    Request changed = request;
    changed.query[name] = value;
    return changed;
  };
  EXPECT_NE(refused(with("kind", "gif")).find("png or pcd"), std::string::npos);
  EXPECT_NE(refused(with("depth_bytes", "0")).find("depth_bytes"), std::string::npos);
  EXPECT_NE(refused(with("depth_bytes", "999999999")).find("depth_bytes"), std::string::npos);
  EXPECT_NE(refused(with("depth_bytes", "nan")).find("depth_bytes"), std::string::npos);
  EXPECT_NE(refused(with("fx", "")).find("fx"), std::string::npos);
  EXPECT_NE(refused(with("fx", "-1")).find("fx"), std::string::npos);
  EXPECT_NE(refused(with("depth_bytes", "20")).find("truncated"), std::string::npos);
  EXPECT_NE(refused(upload_of(like, "no image", "")).find("PNG"), std::string::npos);
  EXPECT_NE(refused(upload_of(like, color_png, "")).find("depth image"), std::string::npos);
  // Metres for millimetres: no depth is left, and the doctor says why.
  EXPECT_NE(refused(with("depth_scale_mm", "1000")).find("wrong unit: its median is 1234 m"),
            std::string::npos)
      << refused(with("depth_scale_mm", "1000"));
  EXPECT_FALSE(
      refused(upload_of(like,
                        *io::encode_gray_png({64, 48, std::vector<std::uint16_t>(64 * 48, 0)}), ""))
          .empty());
}

}  // namespace
}  // namespace bpa::server::web
