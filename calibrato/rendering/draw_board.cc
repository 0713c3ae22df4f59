#include "calibrato/rendering/draw_board.h"

#include <cairo-pdf.h>
#include <cairo-svg.h>
#include <cairo.h>

#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <memory>
#include <numbers>
#include <regex>

#include "calibrato/base/input_error.h"
#include "calibrato/rendering/board_pattern.h"
#include "calibrato/rendering/png_resolution.h"

namespace calibrato {
namespace {

using Eigen::Vector2d;

using Surface = std::unique_ptr<cairo_surface_t, decltype(&cairo_surface_destroy)>;
using Context = std::unique_ptr<cairo_t, decltype(&cairo_destroy)>;

// All lengths on the page [mm], from its upper left, x to the right and y down.
constexpr double kPageMargin = 8.0;  // what common printers leave blank
constexpr double kStripHeight = 20.0;
constexpr double kLargestPage = 5000.0;
constexpr double kMaxPixels = 200e6;
constexpr double kPointsPerMillimetre = 72.0 / 25.4;

struct Layout {
  Vector2d page;
  Vector2d sheet;       // size
  Vector2d sheet_from;  // upper left
  Vector2d strip_from;
  double strip_width;
};

// How much wider the page must be than the sheet on each side, for the ink to stay off its edges.
Vector2d WhiteMissing(const BoardPattern& pattern) {
  Eigen::AlignedBox2d ink;
  for (const BoardPattern::Outline& outline : pattern.outlines) {
    for (const Vector2d& corner : outline) ink.extend(corner);
  }
  for (const BoardPattern::Disc& disc : pattern.discs) {
    const Vector2d radius(disc.radius_m, disc.radius_m);
    ink.extend(disc.centre - radius).extend(disc.centre + radius);
  }
  const Vector2d white = 1e3 * (ink.min() - pattern.sheet.min());
  return (kPageMargin - white.array()).max(0.0);
}

Layout LayOut(const BoardPattern& pattern) {
  const auto upright = [&](const Vector2d& on_board) {
    return pattern.right.x() != 0.0 ? on_board : Vector2d(on_board.y(), on_board.x());
  };
  Layout layout;
  layout.sheet = upright(1e3 * pattern.sheet.sizes());
  const Vector2d missing = upright(WhiteMissing(pattern));
  const double below = kStripHeight + kPageMargin;
  const Vector2d needed = layout.sheet + Vector2d(2.0 * missing.x(), missing.y() + below);
  layout.page = needed.cwiseMax(Vector2d(100.0, 0.0));  // wide enough for the text
  constexpr std::array<std::pair<double, double>, 5> kIsoSizes = {
      std::pair{210.0, 297.0}, {297.0, 420.0}, {420.0, 594.0}, {594.0, 841.0}, {841.0, 1189.0}};
  for (const auto& [narrow, wide] : kIsoSizes) {
    const auto fits = [&](const Vector2d& page) { return (needed.array() <= page.array()).all(); };
    const Vector2d standing(narrow, wide);
    const Vector2d lying(wide, narrow);
    if (!fits(standing) && !fits(lying)) continue;
    layout.page = fits(standing) ? standing : lying;
    break;
  }
  const Vector2d spare = layout.page - layout.sheet - Vector2d(0.0, below);
  layout.sheet_from = {0.5 * spare.x(), std::max(missing.y(), 0.5 * spare.y())};
  layout.strip_from = {kPageMargin, layout.sheet_from.y() + layout.sheet.y()};
  layout.strip_width = layout.page.x() - 2.0 * kPageMargin;
  return layout;
}

// Board to page, for a context whose unit is the millimetre.
cairo_matrix_t BoardOnPage(const BoardPattern& pattern, const Layout& layout) {
  const Vector2d right = 1e3 * pattern.right;
  const Vector2d down(right.y(), -right.x());
  cairo_matrix_t matrix;
  cairo_matrix_init(&matrix, right.x(), down.x(), right.y(), down.y(), 0.0, 0.0);
  Vector2d middle = pattern.sheet.center();
  cairo_matrix_transform_point(&matrix, &middle.x(), &middle.y());
  const Vector2d shift = layout.sheet_from + 0.5 * layout.sheet - middle;
  matrix.x0 = shift.x();
  matrix.y0 = shift.y();
  return matrix;
}

void DrawPattern(cairo_t* context, const BoardPattern& pattern, const Layout& layout) {
  cairo_save(context);
  const cairo_matrix_t board_on_page = BoardOnPage(pattern, layout);
  cairo_transform(context, &board_on_page);
  for (const BoardPattern::Outline& outline : pattern.outlines) {
    cairo_new_sub_path(context);
    for (const Vector2d& corner : outline) cairo_line_to(context, corner.x(), corner.y());
    cairo_close_path(context);
  }
  for (const BoardPattern::Disc& disc : pattern.discs) {
    cairo_new_sub_path(context);
    cairo_arc(context, disc.centre.x(), disc.centre.y(), disc.radius_m, 0.0,
              2.0 * std::numbers::pi);
  }
  cairo_fill(context);
  cairo_restore(context);
}

void DrawRuler(cairo_t* context, const Vector2d& from, double width) {
  const int length = 10 * static_cast<int>(std::min(100.0, width - 10.0) / 10.0);
  cairo_set_line_width(context, 0.2);
  cairo_move_to(context, from.x() - 0.1, from.y());
  cairo_line_to(context, from.x() + length + 0.1, from.y());
  for (int mark = 0; mark <= length; ++mark) {
    const double height = mark % 10 == 0 ? 4.0 : mark % 5 == 0 ? 3.0 : 2.0;
    cairo_move_to(context, from.x() + mark, from.y());
    cairo_line_to(context, from.x() + mark, from.y() - height);
  }
  cairo_stroke(context);
  cairo_move_to(context, from.x() + length + 2.0, from.y());
  cairo_show_text(context, (std::to_string(length) + " mm").c_str());
}

// In letters as large as fit, 3.2 mm at most.
void DrawLine(cairo_t* context, const Vector2d& from, double width, const std::string& text) {
  constexpr double kLetters = 3.2;
  cairo_set_font_size(context, kLetters);
  cairo_text_extents_t extents;
  cairo_text_extents(context, text.c_str(), &extents);
  cairo_set_font_size(context, kLetters * std::min(1.0, width / extents.x_advance));
  cairo_move_to(context, from.x(), from.y());
  cairo_show_text(context, text.c_str());
}

std::string WhatToMeasure(const Board& board, const BoardPattern& pattern) {
  const char* between = "inner corners";
  if (std::holds_alternative<AprilGrid>(board)) between = "edges of tags";
  if (std::holds_alternative<CircleGrid>(board)) between = "centres of discs";
  const Eigen::Matrix3Xd points = BoardPoints(board);
  const Vector2d size = (points.rowwise().maxCoeff() - points.rowwise().minCoeff()).head<2>() * 1e3;
  const bool x_is_across = pattern.right.x() != 0.0;
  const auto rounded = [](double mm) { return FormatNumber(std::round(mm * 1e3) / 1e3); };
  return "Print at 100 %, not fitted to the page. Then measure the ruler, and between the "
         "outermost " +
         std::string(between) + ": " + rounded(x_is_across ? size.x() : size.y()) + " mm across, " +
         rounded(x_is_across ? size.y() : size.x()) + " mm down.";
}

void DrawPage(cairo_t* context, const Board& board, const BoardPattern& pattern,
              const Layout& layout) {
  cairo_set_tolerance(context, 1e-3);
  cairo_set_source_rgb(context, 1.0, 1.0, 1.0);
  cairo_paint(context);
  cairo_set_source_rgb(context, 0.0, 0.0, 0.0);
  DrawPattern(context, pattern, layout);
  cairo_select_font_face(context, "Helvetica", CAIRO_FONT_SLANT_NORMAL, CAIRO_FONT_WEIGHT_NORMAL);
  const auto below = [&](double y) -> Vector2d { return layout.strip_from + Vector2d(0.0, y); };
  DrawLine(context, below(5.0), layout.strip_width, Describe(board));
  DrawLine(context, below(9.5), layout.strip_width, WhatToMeasure(board, pattern));
  cairo_set_font_size(context, 3.2);
  DrawRuler(context, below(17.0), layout.strip_width);
}

cairo_status_t Append(void* file, const unsigned char* bytes, unsigned int count) {
  static_cast<std::string*>(file)->append(reinterpret_cast<const char*>(bytes), count);
  return CAIRO_STATUS_SUCCESS;
}

void CheckDrawn(cairo_status_t status) {
  if (status == CAIRO_STATUS_SUCCESS) return;
  throw InputError({"cannot draw the board", "", cairo_status_to_string(status), ""});
}

// Cairo numbers the surfaces of a process; its SVG tells this one's.
std::string WithoutCounter(const std::string& svg) {
  return std::regex_replace(svg, std::regex("id=\"surface[0-9]+\""), "id=\"board\"");
}

// Everything is written when context and surface have gone.
std::string DrawVectors(const Board& board, const BoardPattern& pattern, const Layout& layout,
                        DrawingFormat format) {
  std::string file;
  const Vector2d size = kPointsPerMillimetre * layout.page;
  const Surface surface(
      format == DrawingFormat::kPdf
          ? cairo_pdf_surface_create_for_stream(Append, &file, size.x(), size.y())
          : cairo_svg_surface_create_for_stream(Append, &file, size.x(), size.y()),
      cairo_surface_destroy);
  if (format == DrawingFormat::kPdf) {
    cairo_pdf_surface_set_metadata(surface.get(), CAIRO_PDF_METADATA_TITLE,
                                   Describe(board).c_str());
    // No date, so that the same board gives the same bytes.
    cairo_pdf_surface_set_metadata(surface.get(), CAIRO_PDF_METADATA_CREATE_DATE, "");
  }
  const Context context(cairo_create(surface.get()), cairo_destroy);
  cairo_scale(context.get(), kPointsPerMillimetre, kPointsPerMillimetre);
  DrawPage(context.get(), board, pattern, layout);
  cairo_show_page(context.get());
  CheckDrawn(cairo_status(context.get()));
  cairo_surface_finish(surface.get());
  CheckDrawn(cairo_surface_status(surface.get()));
  return format == DrawingFormat::kSvg ? WithoutCounter(file) : file;
}

std::string DrawPixels(const Board& board, const BoardPattern& pattern, const Layout& layout,
                       double dpi) {
  const int pixels_per_metre = static_cast<int>(std::lround(dpi / 0.0254));
  const double scale = 1e-3 * pixels_per_metre;
  const Vector2d size = (scale * layout.page).array().round();
  if (size.x() * size.y() > kMaxPixels || size.maxCoeff() > 32767.0) {
    throw InputError(
        {"page too large for a PNG", "",
         "it would have " + FormatNumber(size.x()) + " x " + FormatNumber(size.y()) + " pixels",
         "lower --dpi, or draw a PDF or SVG"});
  }
  const Surface surface(cairo_image_surface_create(CAIRO_FORMAT_RGB24, static_cast<int>(size.x()),
                                                   static_cast<int>(size.y())),
                        cairo_surface_destroy);
  const Context context(cairo_create(surface.get()), cairo_destroy);
  cairo_set_antialias(context.get(), CAIRO_ANTIALIAS_BEST);
  cairo_scale(context.get(), scale, scale);
  DrawPage(context.get(), board, pattern, layout);
  CheckDrawn(cairo_status(context.get()));
  std::string file;
  CheckDrawn(cairo_surface_write_to_png_stream(surface.get(), Append, &file));
  return WithResolution(file, pixels_per_metre);
}

}  // namespace

std::string DrawBoard(const Board& board, DrawingFormat format, const DrawingOptions& options) {
  assert(options.dpi >= 36.0 && options.dpi <= 2400.0);
  const BoardPattern pattern = PatternOf(board);
  const Layout layout = LayOut(pattern);
  if (!(layout.page.maxCoeff() <= kLargestPage)) {
    throw InputError({"board too large to draw", "",
                      "it needs a page of " + FormatNumber(std::round(layout.page.x())) + " x " +
                          FormatNumber(std::round(layout.page.y())) + " mm, more than 5 m",
                      "check its sizes: they are in metres"});
  }
  return format == DrawingFormat::kPng ? DrawPixels(board, pattern, layout, options.dpi)
                                       : DrawVectors(board, pattern, layout, format);
}

}  // namespace calibrato
