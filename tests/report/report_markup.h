#pragma once

#include <string>
#include <string_view>
#include <vector>

// Checks of HTML and SVG for tests of the report: well-formed markup, and texts that overlap or leave the
// drawing.

namespace osteon::report {

/// Returns the first error of a page or drawing that has to be well-formed like XML: tags balanced,
/// attributes quoted and unique, entities known, no stray markup character. Empty if there is none. Knows
/// `<!DOCTYPE …>` and the raw text of `<style>`.
[[nodiscard]] std::string MarkupError(std::string_view markup);

/// The estimated bounding box of one <text> of a drawing [px], y downward.
struct TextBox {
  std::string text{};  ///< an apostrophe for each escaped character
  double size_px{0.0};
  double left{0.0}, top{0.0}, right{0.0}, bottom{0.0};
};
[[nodiscard]] std::vector<TextBox> TextBoxes(std::string_view svg);

/// Returns the first two <text> of a drawing whose boxes overlap, as "one | other"; empty if none do.
[[nodiscard]] std::string TextsOverlapping(std::string_view svg);

/// Returns the first <text> whose box exceeds the drawing's width or height; empty if there is none.
[[nodiscard]] std::string TextOutside(std::string_view svg);

/// Returns the value of an attribute of the first `element` in the markup; empty if there is none.
[[nodiscard]] std::string AttributeOf(std::string_view markup, std::string_view element,
                                      std::string_view attribute);

}  // namespace osteon::report
