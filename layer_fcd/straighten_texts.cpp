// SPDX-License-Identifier: GPL-3.0-or-later
#include "straighten_texts.h"

StraightenTexts straightenTexts() {
    StraightenTexts texts;
    texts.middle = {"Through the middle",
                    {},
                    "Takes the line through the middles of the surface's cross-sections along the given one, which may "
                    "then lie on the surface, as picked points do. Without it, what lies beside the line at the inner "
                    "side of a bend gets longer, and the line keeps its length. It is left where the surface would be "
                    "stretched more along it, as where cross-sections tell no middle; the log says so."};
    texts.shape = {"Becomes",
                   {"A straight line", "An arc", "The line of a layer"},
                   "What the line becomes. A straight line, or an arc of a circle, lies where the line does: their "
                   "middles are at one place. The frames along the line turn as little as they may."};
    texts.angle = {"Angle of the arc (degrees)",
                   {},
                   "By how much the arc bends from end to end, less than 360; negative: to the other side."};
    texts.direction = {"Direction",
                       {},
                       "That of the straight line, or of the middle of the arc. <b>0 0 0</b> (the default): from end "
                       "to end of the line."};
    texts.towards = {"Bends towards",
                     {},
                     "The direction to which the ends of the arc bend. <b>0 0 0</b> (the default): to where those of "
                     "the line do."};
    texts.target = {"Line of a layer",
                    {},
                    "A layer with edges that form one open path. The line is laid along it from its beginning, and "
                    "goes on straight where it is longer. Only read when the line becomes that of a layer."};
    texts.reverse = {"From its other end",
                     {},
                     "Lays the line along that of the layer from its other end. A line of a layer begins at the end "
                     "whose vertex has the smaller number."};
    texts.length = {"Length",
                    {},
                    "How long the line gets, in world units: the surface is stretched along it, and keeps its "
                    "cross-sections. <b>0</b> (the default): as long as it is."};
    texts.untwist = {"Take the twist out",
                     {},
                     "Turns the cross-sections about the line so that their longest axes lie alike, as that in the "
                     "middle. They must not be round. Without it, the twist stays as it is."};
    return texts;
}
