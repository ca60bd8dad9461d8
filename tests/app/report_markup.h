#pragma once

#include <string>
#include <string_view>
#include <vector>

namespace osteon::app {

/// First error of a page or drawing that has to be well-formed like XML: tags balanced, attributes quoted and
/// unique, entities known, no stray markup character. Empty where there is none. Knows `<!DOCTYPE …>` and the
/// raw text of
/// `<style>`.
[[nodiscard]] std::string MarkupError(std::string_view markup);

/// Where a <text> of a drawing is estimated to lie [px], y downward.
struct TextBox {
  std::string text{};  ///< an apostrophe for each escaped character
  double size_px{0.0};
  double left{0.0}, top{0.0}, right{0.0}, bottom{0.0};
};
[[nodiscard]] std::vector<TextBox> TextBoxes(std::string_view svg);

/// First two <text> of a drawing that are estimated to overlap, "one | other"; empty where none do.
[[nodiscard]] std::string TextsOverlapping(std::string_view svg);

/// First <text> of a drawing that is estimated to reach out of its viewBox; empty where there is none.
[[nodiscard]] std::string TextOutside(std::string_view svg);

/// Value of an attribute of the first element of that name; empty where there is none.
[[nodiscard]] std::string AttributeOf(std::string_view markup, std::string_view element,
                                      std::string_view attribute);

}  // namespace osteon::app
