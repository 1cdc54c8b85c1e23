// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
// What browsers send to the page: queries, searches, parameters, uploads.
#include "core/io/image_file.hpp"
#include "server/web/http.hpp"
#include "server/web/search_request.hpp"
#include "server/web/to_json.hpp"
#include "tests/fuzz/target.hpp"

namespace bpa::fuzz {
namespace {

namespace web = server::web;

std::shared_ptr<const Frame> small_frame() {
  Frame frame;
  frame.camera = {64, 48, 60, 60, 31.5, 23.5};
  frame.depth.assign(64 * 48, 1.5f);
  return std::make_shared<const Frame>(std::move(frame));
}

void run_web_query(std::string_view bytes) { (void)web::parse_query(bytes); }

std::vector<std::string> web_query_seeds() {
  return {"viewer=1-2&sequence=12&result=3&tracks=1", "a=%41+b&c=%2e%2e%2f&d"};
}

void run_web_search(std::string_view bytes) {
  auto job = web::search_job(std::string(bytes), small_frame(), {});
  if (!job.ok()) return;
  require(job->request.top_k >= 1 && job->request.top_k <= 100, "top_k is in its range");
  const auto frame = std::move(job->decode)();
  require(frame.ok() && validate(*frame).ok(), "a frame that is searched is legal");
}

std::vector<std::string> web_search_seeds() {
  return {R"({"models": ["mug"], "top_k": 3, "budget_ms": 70, "seed": 5})",
          R"({"region": [3, 4, 20, 10], "polygon": [[5, 5], [45, 5], [45, 40.5]]})"};
}

void run_web_parameter(std::string_view bytes) {
  (void)web::parameter_from_json(std::string(bytes));
}

std::vector<std::string> web_parameter_seeds() {
  return {R"({"name": "detection.top_k", "value": 5})",
          R"({"name": "node.remaps", "value": ["a"]})",
          R"({"name": "use_sim_time", "value": true})",
          R"({"name": "detection.hang_s", "value": 5.5})",
          R"({"name": "tracking.fixed_frame", "value": "map"})",
          R"({"name": "detection.hang_s", "value": "x"})",
          R"({"name": "nothing", "value": 1})",
          R"({"name": 1})"};
}

/// The query in the first line, the body after it.
void run_web_upload(std::string_view bytes) {
  const std::size_t end = std::min(bytes.find('\n'), bytes.size());
  auto query = web::parse_query(bytes.substr(0, end));
  if (!query.ok()) return;
  web::Request request;
  request.query = *query;
  request.body = bytes.substr(std::min(end + 1, bytes.size()));
  const auto frame = web::uploaded_frame(request, 2.5);
  if (frame.ok()) require(validate(*frame).ok(), "an uploaded frame is legal");
}

std::vector<std::string> web_upload_seeds() {
  const std::string depth =
      *io::encode_gray_png({64, 48, std::vector<std::uint16_t>(64 * 48, 1200)});
  const std::string color = *io::encode_color_png({64, 48, std::vector<std::uint8_t>(9216, 9)});
  return {"kind=png&depth_bytes=" + std::to_string(depth.size()) +
              "&fx=60&fy=60&cx=31.5&cy=23.5&depth_scale_mm=1\n" + depth + color,
          "kind=pcd\nVERSION .7\nFIELDS x y z\nSIZE 4 4 4\nTYPE F F F\nCOUNT 1 1 1\nWIDTH 2\n"
          "HEIGHT 2\nPOINTS 4\nDATA ascii\n0 0 1\n1 0 1\n0 1 1\n1 1 1\n"};
}

}  // namespace

std::vector<Target> web_targets() {
  const char* const searches = "server/web/search_request.cpp";
  return {{"web_query", "server/web/http.cpp", run_web_query, web_query_seeds, 2048},
          {"web_search", searches, run_web_search, web_search_seeds, 4096},
          {"web_parameter", "server/web/to_json.cpp", run_web_parameter, web_parameter_seeds, 1024},
          {"web_upload", searches, run_web_upload, web_upload_seeds, 8192, 800}};
}

}  // namespace bpa::fuzz
