// SPDX-FileCopyrightText: 2026 The bpa authors
// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace bpa::draw {

/// A page of headings, paragraphs, tables and pictures, in one file. Strings are plain text, which
/// is escaped, unless the function says HTML.
class HtmlPage {
 public:
  explicit HtmlPage(std::string_view title);

  void heading(std::string_view text);
  void paragraph(std::string_view text);
  /// `text` beside the picture's file name, the picture below; `file` is relative to the page.
  void picture(std::string_view file, std::string_view text);
  /// The cells of `rows` are HTML.
  void table(const std::vector<std::string>& head,
             const std::vector<std::vector<std::string>>& rows);
  /// The whole page.
  std::string finish() const;

  static std::string escape(std::string_view text);
  /// A bar as HTML, to the right if positive, else to the left: 12 pixels for 1, 120 from 10 on.
  static std::string bar(double value);
  static std::string link(std::string_view file, std::string_view text);

 private:
  std::string body_;
};

}  // namespace bpa::draw
