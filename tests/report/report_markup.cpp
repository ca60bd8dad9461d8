#include "report_markup.h"

#include <cctype>
#include <map>
#include <regex>
#include <vector>

#include "report/svg_text.h"

namespace osteon::report {
namespace {

// The end of an error message: the 80 characters from `at` on.
std::string QuoteFrom(std::string_view markup, std::size_t at) {
  return " near: " + std::string(markup.substr(at, 80));
}

bool BeginsWithKnownEntity(std::string_view text) {
  static const std::regex known("^&(amp|lt|gt|quot|#[0-9]+);");
  return std::regex_search(std::string(text.substr(0, 12)), known);
}

}  // namespace

std::string MarkupError(std::string_view markup) {
  std::vector<std::string> open;
  std::size_t i = 0;
  while (i < markup.size()) {
    const char c = markup[i];
    if (c == '&' && !BeginsWithKnownEntity(markup.substr(i))) return "unknown entity" + QuoteFrom(markup, i);
    if (c == '>') return "stray >" + QuoteFrom(markup, i);
    if (c != '<') {
      ++i;
      continue;
    }
    if (markup.substr(i, 9) == "<!DOCTYPE") {
      i = markup.find('>', i) + 1;
      continue;
    }
    const std::size_t start = i;
    const bool closing = i + 1 < markup.size() && markup[i + 1] == '/';
    i += closing ? 2 : 1;
    std::string name;
    while (i < markup.size() && (std::isalnum(static_cast<unsigned char>(markup[i])) != 0))
      name += markup[i++];
    if (name.empty()) return "stray <" + QuoteFrom(markup, start);
    // the tag's attributes, up to its end
    std::map<std::string, std::string> attributes;
    bool self_closed = false;
    while (true) {
      const std::size_t before = i;
      while (i < markup.size() && (std::isspace(static_cast<unsigned char>(markup[i])) != 0)) ++i;
      if (i >= markup.size()) return "tag without end" + QuoteFrom(markup, start);
      if (markup[i] == '>') break;
      if (markup[i] == '/' && i + 1 < markup.size() && markup[i + 1] == '>') {
        self_closed = true;
        ++i;
        break;
      }
      if (before == i) return "no space before an attribute" + QuoteFrom(markup, start);
      std::string key;
      while (i < markup.size() &&
             (std::isalnum(static_cast<unsigned char>(markup[i])) != 0 || markup[i] == '-'))
        key += markup[i++];
      if (key.empty() || markup.substr(i, 2) != "=\"")
        return "attribute not quoted" + QuoteFrom(markup, start);
      const std::size_t end = markup.find('"', i + 2);
      if (end == std::string_view::npos) return "quote without end" + QuoteFrom(markup, start);
      const std::string_view value = markup.substr(i + 2, end - i - 2);
      if (value.find('<') != std::string_view::npos) return "< in an attribute" + QuoteFrom(markup, start);
      for (std::size_t k = value.find('&'); k != std::string_view::npos; k = value.find('&', k + 1))
        if (!BeginsWithKnownEntity(value.substr(k))) return "unknown entity" + QuoteFrom(markup, start);
      if (!attributes.emplace(key, value).second) return "attribute twice" + QuoteFrom(markup, start);
      i = end + 1;
    }
    ++i;
    if (closing) {
      if (open.empty() || open.back() != name) return "unexpected end of " + name + QuoteFrom(markup, start);
      open.pop_back();
    } else if (!self_closed) {
      open.push_back(name);
      if (name == "style" || name == "script") i = markup.find("</" + name + ">", i);
    }
  }
  return open.empty() ? "" : open.back() + " is not closed";
}

std::vector<TextBox> TextBoxes(std::string_view svg) {
  const std::string text(svg);
  static const std::regex element(
      "<text x=\"([^\"]*)\" y=\"([^\"]*)\" text-anchor=\"([a-z]*)\" fill=\"[^\"]*\" "
      "font-size=\"([^\"]*)\"([^>]*)>([^<]*)<");
  std::vector<TextBox> boxes;
  for (std::sregex_iterator it(text.begin(), text.end(), element), end; it != end; ++it) {
    const double x = std::stod((*it)[1]), y = std::stod((*it)[2]), size = std::stod((*it)[4]);
    const std::string anchor = (*it)[3];
    static const std::regex entity("&[^;]*;");
    TextBox box{.text = std::regex_replace((*it)[6].str(), entity, "'"), .size_px = size};
    const double length = TextWidth(box.text, size);
    const double from = anchor == "start" ? 0.0 : anchor == "middle" ? -length / 2 : -length;
    // a capital's height is 0.7 of the font size
    if ((*it)[5].str().find("rotate(-90") != std::string::npos) {
      box.left = x - 0.7 * size;
      box.right = x;
      // turned upward: the text runs from y to y - length
      box.top = y - from - length;
      box.bottom = y - from;
    } else {
      box.left = x + from;
      box.right = x + from + length;
      box.top = y - 0.7 * size;
      box.bottom = y;
    }
    boxes.push_back(box);
  }
  return boxes;
}

std::string TextOutside(std::string_view svg) {
  const double width = std::stod(AttributeOf(svg, "svg", "width")),
               height = std::stod(AttributeOf(svg, "svg", "height"));
  const double slack = 1.0;  // coordinates are rounded to a tenth, widths are estimates
  for (const TextBox& box : TextBoxes(svg))
    if (box.left < -slack || box.right > width + slack || box.top < -slack || box.bottom > height + slack)
      return box.text;
  return {};
}

std::string TextsOverlapping(std::string_view svg) {
  const std::vector<TextBox> boxes = TextBoxes(svg);
  for (std::size_t i = 0; i < boxes.size(); ++i)
    for (std::size_t j = 0; j < i; ++j)
      if (boxes[i].left < boxes[j].right && boxes[j].left < boxes[i].right &&
          boxes[i].top < boxes[j].bottom && boxes[j].top < boxes[i].bottom)
        return boxes[j].text + " | " + boxes[i].text;
  return {};
}

std::string AttributeOf(std::string_view markup, std::string_view element, std::string_view attribute) {
  const std::size_t tag = markup.find("<" + std::string(element) + " ");
  if (tag == std::string_view::npos) return {};
  const std::string key = " " + std::string(attribute) + "=\"";
  const std::size_t at = markup.find(key, tag);
  if (at == std::string_view::npos) return {};
  const std::size_t begin = at + key.size();
  return std::string(markup.substr(begin, markup.find('"', begin) - begin));
}

}  // namespace osteon::report
