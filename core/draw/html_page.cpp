// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#include "core/draw/html_page.hpp"

#include <algorithm>
#include <cstdlib>

namespace bpa::draw {
namespace {

constexpr std::string_view kHead =
    "<!DOCTYPE html>\n<html lang=\"en\"><head><meta charset=\"utf-8\">\n<style>\n"
    "body{font-family:sans-serif;max-width:1280px;margin:2em auto;padding:0 1em;color:#222}\n"
    "img{max-width:100%;border:1px solid #ccc}\n"
    "table{border-collapse:collapse}\n"
    "th,td{padding:.25em .8em;border-bottom:1px solid #ddd;text-align:left;vertical-align:top}\n"
    "code{color:#555}\n</style>\n";

}  // namespace

std::string HtmlPage::escape(std::string_view text) {
  std::string out;
  for (const char c : text) {
    const char* const entity = c == '&'   ? "&amp;"
                               : c == '<' ? "&lt;"
                               : c == '>' ? "&gt;"
                               : c == '"' ? "&quot;"
                                          : nullptr;
    out += entity ? entity : std::string(1, c);
  }
  return out;
}

std::string HtmlPage::bar(double value) {
  const int length = static_cast<int>(12 * std::clamp(value, -10.0, 10.0));
  return "<div style=\"background:" + std::string(length > 0 ? "#3ca050" : "#d7463c") +
         ";height:1em;width:" + std::to_string(std::abs(length)) +
         "px;margin-left:" + std::to_string(120 + std::min(0, length)) + "px\"></div>";
}

std::string HtmlPage::link(std::string_view file, std::string_view text) {
  return "<a href=\"" + escape(file) + "\">" + escape(text) + "</a>";
}

HtmlPage::HtmlPage(std::string_view title)
    : body_("<title>" + escape(title) + "</title></head><body>\n<h1>" + escape(title) + "</h1>\n") {
}

void HtmlPage::heading(std::string_view text) { body_ += "<h2>" + escape(text) + "</h2>\n"; }

void HtmlPage::paragraph(std::string_view text) { body_ += "<p>" + escape(text) + "</p>\n"; }

void HtmlPage::picture(std::string_view file, std::string_view text) {
  body_ += "<p><code>" + escape(file) + "</code> " + escape(text) + "</p>\n<img src=\"" +
           escape(file) + "\" alt=\"\">\n";
}

void HtmlPage::table(const std::vector<std::string>& head,
                     const std::vector<std::vector<std::string>>& rows) {
  body_ += "<table>\n<tr>";
  for (const std::string& cell : head) body_ += "<th>" + escape(cell) + "</th>";
  body_ += "</tr>\n";
  for (const auto& row : rows) {
    body_ += "<tr>";
    for (const std::string& cell : row) body_ += "<td>" + cell + "</td>";
    body_ += "</tr>\n";
  }
  body_ += "</table>\n";
}

std::string HtmlPage::finish() const { return std::string(kHead) + body_ + "</body></html>\n"; }

}  // namespace bpa::draw
