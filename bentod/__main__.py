"""`python -m bentod` and the command `bentod`."""

from bentod.cli.main import bentod


def main() -> None:
    """Run the command line."""
    bentod(prog_name="bentod")


if __name__ == "__main__":
    main()
