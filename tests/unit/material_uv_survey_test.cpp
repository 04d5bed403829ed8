// How large tiles come out on surfaces.
#include <gtest/gtest.h>

#include "material/model/directions.h"
#include "material/model/uv_survey.h"

namespace loden {
namespace {

// A rectangle of width x height metres, whose texture coordinates run to `uv`.
void addRectangle(UvSurvey& survey, double width, double height, const glm::dvec2& uv) {
  const glm::dvec3 x(width, 0, 0), y(0, 0, height);
  survey.add({glm::dvec3(0), x, x + y}, {glm::dvec2(0), glm::dvec2(uv.x, 0), uv});
  survey.add({glm::dvec3(0), x + y, y}, {glm::dvec2(0), uv, glm::dvec2(0, uv.y)});
}

TEST(UvSurvey, MeasuresMetresPerUnit) {
  UvSurvey survey;
  EXPECT_TRUE(survey.empty());
  addRectangle(survey, 3, 2, {1, 4});
  const glm::dvec2 metres = survey.metresPerUnit();
  EXPECT_NEAR(metres.x, 3, 1e-12);
  EXPECT_NEAR(metres.y, 0.5, 1e-12);
  EXPECT_NEAR(survey.stretch(metres).most, 1, 1e-9);
}

TEST(UvSurvey, LeavesOutWhatHasNoArea) {
  UvSurvey survey;
  survey.add({glm::dvec3(0), glm::dvec3(1, 0, 0), glm::dvec3(2, 0, 0)},
             {glm::dvec2(0), glm::dvec2(1, 0), glm::dvec2(0, 1)});
  survey.add({glm::dvec3(0), glm::dvec3(1, 0, 0), glm::dvec3(0, 1, 0)},
             {glm::dvec2(0), glm::dvec2(1, 0), glm::dvec2(2, 0)});
  EXPECT_TRUE(survey.empty());
}

TEST(UvSurvey, FindsStretch) {
  UvSurvey survey;
  addRectangle(survey, 3, 1, {3, 1});
  addRectangle(survey, 1, 1, {1, 0.25});  // a quarter of the area, where v is four metres a unit
  const UvSurvey::Stretch stretch = survey.stretch(survey.metresPerUnit());
  EXPECT_NEAR(stretch.most, 4, 1e-9);
  EXPECT_NEAR(stretch.share, 0.25, 1e-9);
}

TEST(UvSurvey, ScaleGivesThePeriodThatItWasMadeFor) {
  const glm::dvec2 metres(2, 0.5);
  for (const double degrees : {0.0, 90.0, 180.0, -90.0})
    for (const double aspect : {1.0, 0.5, 3.0}) {
      const double rotation = degrees * kPi / 180;
      const auto scale = scaleForPeriod(metres, 0.02, aspect, rotation);
      ASSERT_TRUE(scale);
      const glm::dvec2 period = periodOfScale(metres, *scale, rotation);
      EXPECT_NEAR(period.x, 0.02, 1e-9) << degrees << " " << aspect;
      EXPECT_NEAR(period.y, 0.02 * aspect, 1e-9) << degrees << " " << aspect;
    }
  EXPECT_TRUE(scaleForPeriod(metres, 0.02, 1, 0.3));
  EXPECT_FALSE(scaleForPeriod(metres, 0.02, 2, 0.3)) << "would be sheared";
}

TEST(UvSurvey, LengthsHaveUnits) {
  EXPECT_DOUBLE_EQ(*lengthFromText("2cm"), 0.02);
  EXPECT_DOUBLE_EQ(*lengthFromText("15mm"), 0.015);
  EXPECT_DOUBLE_EQ(*lengthFromText("0.3m"), 0.3);
  for (const char* text : {"", "2", "cm", "-2cm", "0cm", "nan cm", "2 inches", "2cmm"})
    EXPECT_FALSE(lengthFromText(text)) << text;
}

}  // namespace
}  // namespace loden
