# cmake -DINPUT=page.html -DOUTPUT=page.cpp -P EmbedText.cmake
file(READ "${INPUT}" text)
string(LENGTH "${text}" length)
set(pieces "")
set(at 0)
while(at LESS length)
  string(SUBSTRING "${text}" ${at} 32000 piece)
  string(APPEND pieces "\nR\"ajar_page(${piece})ajar_page\"")
  math(EXPR at "${at} + 32000")
endwhile()
file(WRITE "${OUTPUT}" "#include <string_view>
namespace ajar::page {
extern const std::string_view kPage;
const std::string_view kPage =${pieces};
}  // namespace ajar::page
")
