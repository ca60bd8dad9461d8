#include "report/svg_raster.h"

#include <cmath>
#include <memory>

#include <fmt/format.h>
#include <librsvg/rsvg.h>

namespace osteon::report {
namespace {

constexpr double kMaxPixels = 100e6;  // a larger picture is refused

// Copies the pixels of a Cairo surface, which are native-endian words xRGB.
Image FromSurface(cairo_surface_t* surface) {
  cairo_surface_flush(surface);
  Image image{.width = cairo_image_surface_get_width(surface),
              .height = cairo_image_surface_get_height(surface)};
  const unsigned char* data = cairo_image_surface_get_data(surface);
  const int stride = cairo_image_surface_get_stride(surface);
  image.rgb.reserve(static_cast<std::size_t>(image.width) * static_cast<std::size_t>(image.height) * 3);
  for (int y = 0; y < image.height; ++y) {
    const auto* row = reinterpret_cast<const std::uint32_t*>(data + static_cast<std::ptrdiff_t>(y) * stride);
    for (int x = 0; x < image.width; ++x)
      for (const int shift : {16, 8, 0})
        image.rgb.push_back(static_cast<std::uint8_t>(row[x] >> shift & 0xffu));
  }
  return image;
}

// Returns a message with the error's text, and frees the error. @param fallback  text if there is no error
std::string TakeMessage(GError* error, const char* fallback) {
  std::string text = error != nullptr ? error->message : fallback;
  if (error != nullptr) g_error_free(error);
  return "svg: " + text;
}

}  // namespace

tl::expected<Image, std::string> Rasterise(const std::string& svg, double scale) {
  if (!(scale >= 0.1 && scale <= 10.0))
    return tl::unexpected(fmt::format("svg: found a scale of {:g}, accepted 0.1 … 10", scale));
  GError* error = nullptr;
  const std::unique_ptr<RsvgHandle, void (*)(void*)> handle(
      rsvg_handle_new_from_data(reinterpret_cast<const guint8*>(svg.data()), svg.size(), &error),
      g_object_unref);
  if (!handle) return tl::unexpected(TakeMessage(error, "no document"));
  double width = 0.0, height = 0.0;
  if (rsvg_handle_get_intrinsic_size_in_pixels(handle.get(), &width, &height) == FALSE)
    return tl::unexpected(std::string("svg: found no size in pixels"));
  width = std::ceil(width * scale);
  height = std::ceil(height * scale);
  if (!(width >= 1.0 && height >= 1.0 && width * height <= kMaxPixels))
    return tl::unexpected(
        fmt::format("svg: found {:g} x {:g} pixels, accepted 1 to 100 million", width, height));

  const std::unique_ptr<cairo_surface_t, void (*)(cairo_surface_t*)> surface(
      cairo_image_surface_create(CAIRO_FORMAT_RGB24, static_cast<int>(width), static_cast<int>(height)),
      cairo_surface_destroy);
  const std::unique_ptr<cairo_t, void (*)(cairo_t*)> cairo(cairo_create(surface.get()), cairo_destroy);
  cairo_set_source_rgb(cairo.get(), 1.0, 1.0, 1.0);
  cairo_paint(cairo.get());
  const RsvgRectangle viewport{.x = 0.0, .y = 0.0, .width = width, .height = height};
  if (rsvg_handle_render_document(handle.get(), cairo.get(), &viewport, &error) == FALSE)
    return tl::unexpected(TakeMessage(error, "it can't be drawn"));
  if (cairo_status(cairo.get()) != CAIRO_STATUS_SUCCESS)
    return tl::unexpected(std::string("svg: ") + cairo_status_to_string(cairo_status(cairo.get())));
  return FromSurface(surface.get());
}

}  // namespace osteon::report
