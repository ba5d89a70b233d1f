<PickedPoints>&é;</PickedPoints>
