#include "kerf/study/report/page.h"

#include "kerf/study/report/page_style.h"

namespace kerf::report {
namespace {

constexpr std::string_view kPolicy =
    "default-src 'none'; img-src data:; style-src 'unsafe-inline'; script-src 'unsafe-inline'";

void write_head(Markup& out, const PageHead& head) {
  out.open("head");
  out.leaf("meta", {{"charset", "utf-8"}});
  out.leaf("meta", {{"http-equiv", "Content-Security-Policy"}, {"content", kPolicy}});
  out.leaf("meta", {{"name", "viewport"}, {"content", "width=device-width, initial-scale=1"}});
  out.leaf("meta", {{"name", "color-scheme"}, {"content", "light dark"}});
  out.element("title", head.title);
  out.open("style");
  out.raw(page_style());
  out.close();
  out.close();
  out.line();
}

void write_header(Markup& out, const PageHead& head, std::span<const PageSection> contents) {
  out.open("header");
  out.element("h1", head.title);
  if (!head.machine.empty()) out.element("p", {{"class", "made"}}, head.machine);
  if (!head.command.empty()) out.element("code", {{"class", "command"}}, head.command);
  if (!head.notes.empty()) {
    out.open("ul", {{"class", "notes"}});
    for (const std::string& note : head.notes) out.element("li", note);
    out.close();
  }
  out.open("nav", {{"aria-label", "Contents"}});
  out.open("ul");
  for (const PageSection& section : contents) {
    out.open("li");
    out.element("a", {{"href", "#" + section.id}}, section.title);
    out.close();
  }
  out.close();
  out.close();
  out.close();
  out.line();
}

}  // namespace

void begin_page(Markup& out, const PageHead& head, std::span<const PageSection> contents) {
  out.raw("<!DOCTYPE html>\n");
  out.open("html", {{"lang", "en"}});
  write_head(out, head);
  out.open("body");
  out.line();
  write_header(out, head, contents);
  out.open("main");
  out.line();
}

void end_page(Markup& out) {
  out.close();
  out.open("script");
  out.raw(page_script());
  out.close();
  out.close();
  out.close();
  out.line();
}

void write_heading(Markup& out, std::string_view tag, std::string_view text, const std::string& aside) {
  out.open(tag);
  out.text(text);
  if (!aside.empty()) out.element("small", aside);
  out.close();
  out.line();
}

}  // namespace kerf::report
