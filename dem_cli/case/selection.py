"""Selection of blocks in a case file: by id or alias, by a pattern, a group, a structure or its courses."""

from __future__ import annotations

from typing import Annotated, ClassVar

from pydantic import Field, model_validator

from dem_cli.case.base import CaseModel, KeyProblem, Name, Vector
from dem_cli.case.wording import show

PATTERN_SIGNS = "*?"  # in a name: any letters, any letter
Course = Annotated[int, Field(ge=1)]
Courses = Course | tuple[Course, Course] | None
ONE_COURSE_OR_MORE = "with structure: a course of it, from 1 at the foot, or from which to which [first, last]"


class Selection(CaseModel):
    """Keys of every table that selects blocks; `selected` is the name under which models know the selection."""

    needs_blocks: ClassVar[bool] = True  # one of the keys must be given

    block: str | None = Field(
        default=None,
        description="id of a block, a pattern of ids with * and ?, or a name in [groups]",
        examples=["facade-13-*"],
    )
    structure: str | None = Field(
        default=None, description="instead of block: id of a structure, all of its blocks", examples=["left"]
    )
    course: Courses = Field(default=None, description=ONE_COURSE_OR_MORE, examples=[[10, 13]])

    @model_validator(mode="after")
    def _one_selection(self) -> Selection:
        if self.block is not None and self.structure is not None:
            raise KeyProblem("'block' and 'structure' are given; one of them says which blocks", "block")
        if self.block is None and self.structure is None and self.needs_blocks:
            raise KeyProblem("missing; must be a string: the id of a block, a pattern, a group; or give structure",
                             "block")  # fmt: skip
        check_courses(self.structure, self.course)
        return self

    @property
    def selected(self) -> str | None:
        """Name of the selected blocks in messages and models; None: nothing is selected."""
        return self.block if self.block is not None else structure_words(self.structure, self.course)

    @property
    def said(self) -> str:
        """Name of the selected blocks in messages, with quotes."""
        if self.structure is None:
            return show(self.block)
        return structure_words(show(self.structure), self.course) or ""


class GroupMember(CaseModel):
    """groups.NAME: a list under [groups], such as front = ["left-13-*", "crest", { structure = "right", course = 13 }].

    Ids, patterns, other groups and tables: of blocks of one structure, of some of its courses, with centroids in a box.
    """

    structure: str | None = Field(default=None, description="id of a structure; default: all blocks", examples=["left"])
    course: Courses = Field(default=None, description=ONE_COURSE_OR_MORE, examples=[13])
    box: tuple[Vector, Vector] | None = Field(
        default=None,
        description="only blocks with their centroid between these two opposite corners [m]",
        examples=[[[0.0, 2.0], [4.0, 3.0]]],
    )

    @model_validator(mode="after")
    def _something(self) -> GroupMember:
        if self.structure is None and self.box is None:
            raise ValueError("neither 'structure' nor 'box' is given; they say which blocks belong to it")
        check_courses(self.structure, self.course)
        return self


GroupMembers = Annotated[tuple[Name | GroupMember, ...], Field(min_length=1)]


def check_courses(structure: str | None, course: Courses) -> None:
    """Raise KeyProblem for courses given without a structure, or from a higher to a lower one."""
    if course is not None and structure is None:
        raise KeyProblem("not used without structure", "course")
    if isinstance(course, tuple) and course[0] > course[1]:
        raise KeyProblem(f"{show(course)} is not allowed; the first course is not above the last", "course")


def structure_words(structure: str | None, course: Courses) -> str | None:
    """Return the name in words of a structure, or of courses of it."""
    if structure is None:
        return None
    if course is None:
        return f"structure {structure}"
    low, high = course if isinstance(course, tuple) else (course, course)
    return f"structure {structure} course {low}" + (f" to {high}" if high > low else "")


def is_pattern(name: str) -> bool:
    """Test whether a name is a pattern with wildcards."""
    return any(sign in name for sign in PATTERN_SIGNS)
