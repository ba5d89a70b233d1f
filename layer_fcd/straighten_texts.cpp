// SPDX-License-Identifier: GPL-3.0-or-later
#include "straighten_texts.h"

StraightenTexts straightenTexts() {
    StraightenTexts texts;
    texts.middle = {"Through the middle",
                    {},
                    "Moves the line into the middles of the surface's cross-sections. The given line may then lie on "
                    "the surface, as picked points do. Without it, the line keeps its length: the inner side of a bend "
                    "gets longer. The line is left where moving it would stretch the surface more; the log says so."};
    texts.shape = {"New shape",
                   {"A straight line", "An arc", "The line of a layer"},
                   "What the line becomes. The middle of a straight line or an arc is at the middle of the line. The "
                   "frames along the line turn as little as possible."};
    texts.angle = {"Angle of the arc (degrees)",
                   {},
                   "How far the arc bends from end to end, less than 360. Negative: to the other side."};
    texts.direction = {"Direction",
                       {},
                       "Direction of the straight line, or of the middle of the arc. <b>0 0 0</b> (the default): from "
                       "end to end of the line."};
    texts.towards = {
        "Bends towards",
        {},
        "The direction to which the ends of the arc bend. <b>0 0 0</b> (the default): to where those of the line do."};
    texts.target = {"Target line",
                    {},
                    "A layer with edges that form one open path. The line is laid along it from its beginning, and "
                    "goes on straight where it is longer. Only read for 'The line of a layer'."};
    texts.reverse = {"Reverse the target line",
                     {},
                     "Lays the line along the target line from its other end. A line of a layer begins at the end "
                     "whose vertex has the smaller number."};
    texts.length = {"Length",
                    {},
                    "The new length of the line, in world units. The surface is stretched along it and keeps its "
                    "cross-sections. <b>0</b> (the default): as long as it is."};
    texts.untwist = {"Remove twist",
                     {},
                     "Turns cross-sections about the line so that their longest axes lie alike, as in the middle. They "
                     "must not be round."};
    return texts;
}
