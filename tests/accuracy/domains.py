# SPDX-FileCopyrightText: 2026 The bpa authors
# SPDX-License-Identifier: Apache-2.0
"""The domains that the detector is measured on, a row of the table each."""

from dataclasses import dataclass, field, replace
from pathlib import Path


@dataclass(frozen=True)
class Domain:
    """Frames, the models that are searched for in them, and the detector's settings.

    `models` is a folder of the data with models in it, a choice of bpa simulate scenes --models, or
    empty for all household objects.
    """
    name: str
    models: str = ""
    simulate: str = ""       # options of bpa simulate scenes; empty: frames of the data
    folder: str = ""         # of the frames, in the data or among the simulated sets
    settings: str = ""       # lines of the detector's settings beside those of the effort
    chosen_on: bool = False  # options of the detector were chosen on these frames
    nothing_known: bool = False  # the frames are clouds that hold none of the models
    poses: dict = field(default_factory=dict)  # true (q wxyz, t) in the one cloud, by model
    efforts: tuple = ("default", "exhaustive")


# Searched until a round has nothing left to look at.
EFFORTS = {
    "default": "",
    "exhaustive": "max_rounds: 1000\nmax_missed: 0\n",
}
NO_COLOURS = "use_color: false\n"
WORKSHOP = ("pen,screwdriver,wrench,scissors,clamp,spatula,tin,battery,phone,remote,book,soap,"
            "sponge,matchbox")
MILK = ((0.992168, -0.006583, 0.109581, 0.059602), (-0.158966, 0.212498, -0.042125))


def simulated(name, simulate, models="", **more):
    return Domain(name, models, simulate, folder=name.replace(" ", "_"), **more)


def also_without_colours(domain):
    return [domain, replace(domain, name=domain.name + ", no colours", settings=NO_COLOURS)]


def preset(name):
    """The lines of a file of config/presets."""
    path = Path(__file__).resolve().parents[2] / "config" / "presets" / f"{name}.yaml"
    lines = path.read_text(encoding="utf-8").splitlines()
    return "".join(f"{line}\n" for line in lines if not line.startswith("#"))


def piles(name, simulate, **more):
    return simulated(name, "--scenes 8 " + simulate, models="ycbv", **more)


def bins(name, simulate):
    return simulated(name, "--scenes 8 --clutter 1,1 --border 0 --foreign 0,0 --distance 0.6,0.9"
                     " --elevation 60,85 " + simulate, models="industrial")


DOMAINS = [
    *also_without_colours(Domain("ycbv", "ycbv", folder="ycbv", chosen_on=True)),
    Domain("ycbv, paper preset", "ycbv", folder="ycbv", settings=preset("paper"),
           efforts=("default",)),
    *(Domain(f"real {name}", f"real/{name}", folder=f"real/{name}")
      for name in ("bin", "d400", "figure", "flush", "small", "basket", "foreign", "no_depth")),
    Domain("osd_clutter", "ycbv", folder="osd_clutter", nothing_known=True),
    *also_without_colours(
        Domain("pcl_milk", "pcl_milk/milk.pcd", poses={"milk": MILK},
               folder="pcl_milk/milk_cartoon_all_small_clorox.pcd")),
    simulated("piles seed 100", "--scenes 8 --seed 100", chosen_on=True),
    piles("piles seed 777", "--seed 777", chosen_on=True),
    *also_without_colours(piles("piles structured light", "--seed 5001")),
    *also_without_colours(piles("piles active stereo", "--seed 5002 --sensor active_stereo")),
    *also_without_colours(piles("piles time of flight", "--seed 5003 --sensor time_of_flight")),
    simulated("workshop", "--scenes 8 --seed 5004", models=WORKSHOP),
    bins("bins equal parts", "--seed 5005 --objects 10,16 --equal 1"),
    bins("bins several parts", "--seed 5013 --objects 10,16 --equal 1 --kinds 4"),
    bins("bins mixed parts", "--seed 5006 --objects 10,16"),
    piles("far and small",
          "--seed 5007 --objects 3,5 --foreign 8,12 --clutter 0.2,0.6 --distance 1,1.6"),
    piles("1920x1080", "--seed 5008 --size 1920,1080"),
    piles("long lens", "--seed 5009 --focal 1000,1300 --distance 1.2,2"),
    simulated("ambiguous", "--scenes 12 --seed 5010 --ambiguous 1 --border 0"),
    simulated("empty tables", "--scenes 6 --seed 5011 --empty 1"),
    simulated("foreign tables", "--scenes 8 --seed 5012 --distractors 1 --foreign 0,12"),
]
